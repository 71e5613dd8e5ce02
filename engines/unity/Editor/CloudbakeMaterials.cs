// cloudbake @version@: makes the material of a baked GLB. Select GLB files in the Project window, then Assets > Cloudbake > Create
// Material.
using System;
using System.IO;
using System.Text;
using UnityEditor;
using UnityEngine;

public static class CloudbakeMaterials
{
    [Serializable] class Lobes { public float exponent, bias, extinction; public int[] uv_sets; }
    [Serializable] class Extras { public Lobes cloudbake; }
    [Serializable] class Asset { public Extras extras; }
    [Serializable] class Document { public Asset asset; }

    [MenuItem("Assets/Cloudbake/Create Material")]
    static void CreateMaterials()
    {
        foreach (var selected in Selection.objects)
        {
            var path = AssetDatabase.GetAssetPath(selected);
            if (path.EndsWith(".glb", StringComparison.OrdinalIgnoreCase)) CreateMaterial(path);
        }
        AssetDatabase.SaveAssets();
    }

    static void CreateMaterial(string path)
    {
        var lobes = LobesOf(path);
        if (lobes == null || lobes.uv_sets == null || lobes.uv_sets.Length == 0)
        {
            Debug.LogError(path + ": there is no asset.extras.cloudbake in it: bake it with cloudbake");
            return;
        }
        foreach (var number in new[] { lobes.exponent, lobes.bias, lobes.extinction })
            if (float.IsNaN(number) || float.IsInfinity(number))
            {
                Debug.LogError(path + ": exponent, bias or extinction in asset.extras.cloudbake is not finite: bake it again");
                return;
            }
        if (lobes.uv_sets[0] != @first_set@)
        {
            Debug.LogError(path + ": its lobes are in UV set " + lobes.uv_sets[0] + ", and Cloudbake.shader reads set @first_set@: "
                + "write the shader for this asset (cloudbake shader unity ASSET.glb -o DIR)");
            return;
        }
        var material = new Material(Shader.Find("Cloudbake/Cloud")) { enableInstancing = true };
        material.SetFloat("_Exponent", lobes.exponent);
        material.SetFloat("_Bias", lobes.bias);
        material.SetFloat("_Extinction", lobes.extinction);
        AssetDatabase.CreateAsset(material, AssetDatabase.GenerateUniqueAssetPath(Path.ChangeExtension(path, null) + "_cloud.mat"));
    }

    // The JSON of a GLB is its first chunk: a header of 12 bytes, the chunk's length, its type, its text.
    static Lobes LobesOf(string path)
    {
        var bytes = File.ReadAllBytes(path);
        if (bytes.Length < 20 || BitConverter.ToUInt32(bytes, 0) != 0x46546C67) return null;
        var text = Encoding.UTF8.GetString(bytes, 20, BitConverter.ToInt32(bytes, 12));
        return JsonUtility.FromJson<Document>(text)?.asset?.extras?.cloudbake;
    }
}
