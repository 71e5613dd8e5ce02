// cloudbake @version@: what a baked GLB and a shadow's picture say about themselves.
using System;
using System.Text;
using System.Text.RegularExpressions;
using UnityEngine;

public static class CloudbakeAsset
{
    [Serializable]
    public sealed class Lobes
    {
        public float exponent, bias, extinction, density_max;
        public int[] uv_sets;
        public string fit_to;
        public float switch_pixels;  // of a level of detail: the most that the longest side may cover
        // Of an impostor:
        public string layout;
        public int views, frame;
        public float radius, thickest;
        public float[] center;
        public bool gains;
        public SequenceInfo sequence;  // of a sequence
    }

    [Serializable]
    public sealed class SequenceInfo
    {
        public string keys;
        public float frames_per_second, period, density_max;
        public bool loops;
        public Segment[] segments;
    }

    [Serializable]
    public sealed class Segment
    {
        public int mesh, first_row;
        public float[] frames;
    }

    // The frame of a shadow's picture, in the space of glTF.
    [Serializable]
    public sealed class ShadowFrame
    {
        public float[] origin, right, up, to_sun;
        public float width, height, sigma;
    }

    // In the space of Unity.
    public static Vector3 Vector(float[] v) => CloudbakeMath.Mirrored(new Vector3(v[0], v[1], v[2]));

    [Serializable] sealed class Extras { public Lobes cloudbake = null; }
    [Serializable] sealed class Asset { public Extras extras = null; }
    [Serializable] sealed class Image { public string name = null; public int bufferView = 0; }
    [Serializable] sealed class View { public int byteOffset = 0, byteLength = 0; }
    [Serializable] sealed class Document
    {
        public Asset asset = null;
        public Image[] images = null;
        public View[] bufferViews = null;
    }

    // The JSON of a GLB is its first chunk: a header of 12 bytes, the chunk's length, its type, its text. Null if there is none.
    public static string JsonOf(byte[] bytes)
    {
        if (bytes.Length < 20 || BitConverter.ToUInt32(bytes, 0) != 0x46546C67) return null;
        var length = BitConverter.ToUInt32(bytes, 12);
        return length > bytes.Length - 20 ? null : Encoding.UTF8.GetString(bytes, 20, (int)length);
    }

    // Null if cloudbake did not bake it.
    public static Lobes Read(byte[] bytes)
    {
        var text = JsonOf(bytes);
        return text == null ? null : JsonUtility.FromJson<Document>(text)?.asset?.extras?.cloudbake;
    }

    // The box of a sequence, in the space of Unity. JsonUtility reads no lists of lists.
    public static Bounds BoxOf(string json)
    {
        var found = Regex.Match(json, "\"box\"\\s*:\\s*\\[\\s*\\[([^\\]]*)\\]\\s*,\\s*\\[([^\\]]*)\\]");
        var low = Vector(Numbers(found.Groups[1].Value));
        var high = Vector(Numbers(found.Groups[2].Value));
        var size = high - low;
        return new Bounds((low + high) * 0.5f, new Vector3(Mathf.Abs(size.x), size.y, size.z));
    }

    static float[] Numbers(string text) =>
        Array.ConvertAll(text.Split(','), number => float.Parse(number, System.Globalization.CultureInfo.InvariantCulture));

    // The bytes of a picture that is in the file; null if it is not.
    public static byte[] PictureOf(byte[] bytes, string name)
    {
        var text = JsonOf(bytes);
        var document = text == null ? null : JsonUtility.FromJson<Document>(text);
        var image = document?.images == null ? null : Array.Find(document.images, one => one.name == name);
        if (image == null) return null;
        var view = document.bufferViews[image.bufferView];
        var picture = new byte[view.byteLength];
        // The binary chunk begins after the JSON and 8 bytes of its own.
        Array.Copy(bytes, 28 + (int)BitConverter.ToUInt32(bytes, 12) + view.byteOffset, picture, 0, picture.Length);
        return picture;
    }

    // Why a shader that reads the lobes from `set` cannot draw an asset; null if it can.
    public static string FaultOf(Lobes lobes, int set)
    {
        if (IsImpostor(lobes)) return "it is an impostor: choose Assets > Cloudbake > Create Impostor";
        if (IsSequence(lobes)) return "it is a sequence: choose Assets > Cloudbake > Create Sequence";
        if (lobes == null || lobes.uv_sets == null || lobes.uv_sets.Length == 0)
            return "there is no asset.extras.cloudbake in it: bake it with cloudbake";
        foreach (var number in new[] { lobes.exponent, lobes.bias, lobes.extinction })
            if (float.IsNaN(number) || float.IsInfinity(number))
                return "exponent, bias or extinction in asset.extras.cloudbake is not finite: bake it again";
        return lobes.uv_sets[0] == set ? null : "its lobes are in UV set " + lobes.uv_sets[0] + ", and the shaders read set " + set
            + ": write the shaders for this asset (cloudbake shader unity ASSET.glb -o DIR)";
    }

    public static bool IsImpostor(Lobes lobes) => lobes != null && lobes.layout == "lobe-impostor";

    public static bool IsSequence(Lobes lobes) => lobes != null && lobes.layout == "lobe-sequence";

    // Of the mip levels of an impostor's atlas: down to 4 pixels to a side of a view.
    public static int LastLevel(int frame)
    {
        var level = 0;
        for (; frame % 2 == 0 && frame >= 8; frame /= 2) ++level;
        return level;
    }

    // cloud_lod1.glb of cloud.glb.
    public static string LevelFile(string path, int level) => path.Insert(path.Length - 4, "_lod" + level);
}
