// cloudbake @version@: makes what a baked GLB needs. Select GLB files, or a picture of `cloudbake shadow`, in the Project window, then
// Assets > Cloudbake.
using System;
using System.Collections.Generic;
using System.IO;
using UnityEditor;
using UnityEngine;

public static class CloudbakeMaterials
{
    // Of the picture for which levels of detail change.
    const int PictureHeight = 1080;

    // Of the picture of a sequence.
    const int KeyColumns = 1024;

    [MenuItem("Assets/Cloudbake/Create Material")]
    static void CreateMaterials() => ForEachGlb(path => CreateMaterial(path, "Cloudbake/Cloud"));

    [MenuItem("Assets/Cloudbake/Create Painted Material")]
    static void CreatePainted() => ForEachGlb(path => CreateMaterial(path, "Cloudbake/Painted"));

    // In the scene, from the GLB and the levels beside it.
    [MenuItem("Assets/Cloudbake/Create LOD Group")]
    static void CreateGroups() => ForEachGlb(path => CreateGroup(path, "Cloudbake/Cloud"));

    [MenuItem("Assets/Cloudbake/Create Painted LOD Group")]
    static void CreatePaintedGroups() => ForEachGlb(path => CreateGroup(path, "Cloudbake/Painted"));

    // In the scene, from the GLB of `cloudbake impostor` and the two pictures beside it.
    [MenuItem("Assets/Cloudbake/Create Impostor")]
    static void CreateImpostors() => ForEachGlb(CreateImpostor);

    // In the scene, from the GLB of `cloudbake sequence --as picture`.
    [MenuItem("Assets/Cloudbake/Create Sequence")]
    static void CreateSequences() => ForEachGlb(CreateSequence);

    // Makes a shadow's picture the cookie of the scene's sun, which is turned and moved to where it was drawn from.
    [MenuItem("Assets/Cloudbake/Use as Light Cookie")]
    static void UseCookies()
    {
        foreach (var selected in Selection.objects) UseCookie(AssetDatabase.GetAssetPath(selected));
    }

    static void ForEachGlb(Action<string> work)
    {
        foreach (var selected in Selection.objects)
        {
            var path = AssetDatabase.GetAssetPath(selected);
            if (path.EndsWith(".glb", StringComparison.OrdinalIgnoreCase)) work(path);
        }
        AssetDatabase.SaveAssets();
    }

    static Material CreateMaterial(string path, string shader)
    {
        var lobes = CloudbakeAsset.Read(File.ReadAllBytes(path));
        var fault = CloudbakeAsset.FaultOf(lobes, @first_set@);
        if (fault != null)
        {
            Debug.LogError(path + ": " + fault);
            return null;
        }
        var material = new Material(Shader.Find(shader)) { enableInstancing = true };
        material.SetFloat("_Exponent", lobes.exponent);
        material.SetFloat("_Bias", lobes.bias);
        material.SetFloat("_Extinction", lobes.extinction);
        material.SetFloat("_DensityMax", lobes.density_max);
        if (material.HasProperty("_OfVolume")) material.SetFloat("_OfVolume", lobes.fit_to == "volume" ? 1 : 0);
        AssetDatabase.CreateAsset(material, AssetDatabase.GenerateUniqueAssetPath(Path.ChangeExtension(path, null) + "_cloud.mat"));
        return material;
    }

    static void CreateGroup(string path, string shader)
    {
        var material = CreateMaterial(path, shader);
        if (!material) return;
        var root = new GameObject(Path.GetFileNameWithoutExtension(path));
        var levels = new List<LOD>();
        for (var level = 0; ; ++level)
        {
            var file = level == 0 ? path : CloudbakeAsset.LevelFile(path, level);
            var next = CloudbakeAsset.LevelFile(path, level + 1);
            if (!File.Exists(file)) break;
            var part = (GameObject)PrefabUtility.InstantiatePrefab(AssetDatabase.LoadAssetAtPath<GameObject>(file), root.transform);
            var renderers = part.GetComponentsInChildren<Renderer>();
            foreach (var one in renderers) one.sharedMaterial = material;
            var pixels = File.Exists(next) ? CloudbakeAsset.Read(File.ReadAllBytes(next)).switch_pixels : 0;
            levels.Add(new LOD(CloudbakeMath.SwitchHeight(pixels, PictureHeight), renderers) { fadeTransitionWidth = 0.15f });
        }
        var group = root.AddComponent<LODGroup>();
        group.fadeMode = LODFadeMode.CrossFade;
        group.SetLODs(levels.ToArray());
        group.RecalculateBounds();
        if (shader == "Cloudbake/Painted") root.AddComponent<CloudbakeCloud>();
        Undo.RegisterCreatedObjectUndo(root, "Create LOD Group");
    }

    static void CreateImpostor(string path)
    {
        var info = CloudbakeAsset.Read(File.ReadAllBytes(path));
        if (!CloudbakeAsset.IsImpostor(info))
        {
            Debug.LogError(path + ": it is no impostor: make one with `cloudbake impostor`");
            return;
        }
        var center = CloudbakeAsset.Vector(info.center);
        var material = new Material(Shader.Find("Cloudbake/Impostor")) { enableInstancing = true };
        foreach (var name in new[] { "lobe", "rest" })
        {
            var picture = Path.ChangeExtension(path, null) + "_" + name + ".png";
            if (!File.Exists(picture))
            {
                Debug.LogError(picture + " is missing: `cloudbake impostor` writes it beside the GLB");
                return;
            }
            material.SetTexture("impostor_" + name, Numbers(picture, true));
        }
        material.SetFloat("_Exponent", info.exponent);
        material.SetFloat("_Extinction", info.extinction);
        material.SetFloat("_OfVolume", info.gains ? 1 : 0);
        material.SetVector("_Ball", new Vector4(center.x, center.y, center.z, info.radius));
        material.SetVector("impostor_atlas", new Vector4(info.views, info.frame, CloudbakeAsset.LastLevel(info.frame), info.thickest));
        AssetDatabase.CreateAsset(material, AssetDatabase.GenerateUniqueAssetPath(Path.ChangeExtension(path, null) + "_cloud.mat"));
        var shown = (GameObject)PrefabUtility.InstantiatePrefab(AssetDatabase.LoadAssetAtPath<GameObject>(path), null);
        foreach (var one in shown.GetComponentsInChildren<Renderer>()) one.sharedMaterial = material;
        var bounds = shown.AddComponent<CloudbakeImpostor>();
        bounds.center = center;
        bounds.radius = info.radius;
        Undo.RegisterCreatedObjectUndo(shown, "Create Impostor");
    }

    static void CreateSequence(string path)
    {
        var bytes = File.ReadAllBytes(path);
        var info = CloudbakeAsset.Read(bytes);
        var keys = CloudbakeAsset.PictureOf(bytes, "keys");
        if (!CloudbakeAsset.IsSequence(info) || keys == null)
        {
            Debug.LogError(path + ": it has no picture of keys: make it with `cloudbake sequence --as picture`");
            return;
        }
        var picture = Path.ChangeExtension(path, null) + "_keys.png";
        File.WriteAllBytes(picture, keys);
        AssetDatabase.ImportAsset(picture);
        var box = CloudbakeAsset.BoxOf(CloudbakeAsset.JsonOf(bytes));
        var material = new Material(Shader.Find("Cloudbake/Cloud"));
        material.EnableKeyword("CLOUDBAKE_SEQUENCE");
        material.SetFloat("_Sequence", 1);
        material.SetFloat("_Exponent", info.exponent);
        material.SetFloat("_Bias", info.bias);
        material.SetFloat("_Extinction", info.extinction);
        material.SetTexture("sequence_keys", Numbers(picture, false));
        // The shader mirrors x after it has read the keys.
        var low = CloudbakeMath.Mirrored(box.min);
        var high = CloudbakeMath.Mirrored(box.max);
        material.SetVector("sequence_low", new Vector4(high.x, low.y, low.z, 0));
        material.SetVector("sequence_high", new Vector4(low.x, high.y, high.z, 0));
        material.SetFloat("sequence_densest", info.sequence.density_max);
        AssetDatabase.CreateAsset(material, AssetDatabase.GenerateUniqueAssetPath(Path.ChangeExtension(path, null) + "_cloud.mat"));

        var shown = (GameObject)PrefabUtility.InstantiatePrefab(AssetDatabase.LoadAssetAtPath<GameObject>(path), null);
        var renderers = shown.GetComponentsInChildren<Renderer>(true);
        if (renderers.Length != info.sequence.segments.Length)
        {
            Debug.LogError(path + ": its importer has joined or split meshes; a sequence needs one for each segment");
            return;
        }
        var player = shown.AddComponent<CloudbakeSequence>();
        player.framesPerSecond = info.sequence.frames_per_second;
        player.period = info.sequence.period;
        player.loops = info.sequence.loops;
        player.box = box;
        player.parts = Array.ConvertAll(info.sequence.segments, segment => PartOf(segment, renderers[segment.mesh], material));
        if (player.loops && player.parts.Length == 1)
        {
            var other = UnityEngine.Object.Instantiate(renderers[0], renderers[0].transform.parent);
            player.parts = new[] { player.parts[0], PartOf(info.sequence.segments[0], other, material) };
        }
        Undo.RegisterCreatedObjectUndo(shown, "Create Sequence");
    }

    // The nodes are in the order of their meshes.
    static CloudbakeSequence.Part PartOf(CloudbakeAsset.Segment segment, Renderer renderer, Material material)
    {
        var rows = (renderer.GetComponent<MeshFilter>().sharedMesh.vertexCount + KeyColumns - 1) / KeyColumns;
        renderer.sharedMaterial = material;
        renderer.transform.localScale = new Vector3(1, 1, 1);  // the file scales what is not seen by 0
        return new CloudbakeSequence.Part
        {
            renderer = renderer, frames = segment.frames, place = new Vector4(segment.first_row, rows, segment.frames.Length, 0),
        };
    }

    // A picture that is imported as the numbers that it has.
    static Texture2D Numbers(string path, bool hasLevels)
    {
        var importer = (TextureImporter)AssetImporter.GetAtPath(path);
        importer.sRGBTexture = false;
        importer.mipmapEnabled = hasLevels;
        importer.wrapMode = TextureWrapMode.Clamp;
        importer.filterMode = hasLevels ? FilterMode.Trilinear : FilterMode.Point;
        importer.npotScale = TextureImporterNPOTScale.None;
        importer.textureCompression = TextureImporterCompression.Uncompressed;
        importer.maxTextureSize = 16384;
        importer.SaveAndReimport();
        return AssetDatabase.LoadAssetAtPath<Texture2D>(path);
    }

    static void UseCookie(string path)
    {
        var description = Path.ChangeExtension(path, ".json");
        var sun = RenderSettings.sun;
        if (!File.Exists(description) || !sun)
        {
            Debug.LogError(!sun ? "the scene has no sun: set one in Window > Rendering > Lighting > Environment"
                : description + " is missing: `cloudbake shadow` writes it beside the picture");
            return;
        }
        var frame = JsonUtility.FromJson<CloudbakeAsset.ShadowFrame>(File.ReadAllText(description));
        var importer = (TextureImporter)AssetImporter.GetAtPath(path);
        importer.textureType = TextureImporterType.Cookie;
        importer.alphaSource = TextureImporterAlphaSource.FromGrayScale;
        importer.sRGBTexture = false;
        importer.wrapMode = TextureWrapMode.Clamp;
        importer.SaveAndReimport();

        Undo.RecordObjects(new UnityEngine.Object[] { sun, sun.transform }, "Use as Light Cookie");
        sun.transform.position = CloudbakeAsset.Vector(frame.origin);
        sun.transform.rotation = Quaternion.LookRotation(-CloudbakeAsset.Vector(frame.to_sun), CloudbakeAsset.Vector(frame.up));
        sun.cookie = AssetDatabase.LoadAssetAtPath<Texture2D>(path);
        sun.cookieSize = Mathf.Max(frame.width, frame.height);
        // The Universal Render Pipeline has the size in a component of its own.
        var more = sun.GetComponent("UniversalAdditionalLightData");
        if (!more) return;
        var fields = new SerializedObject(more);
        fields.FindProperty("m_LightCookieSize").vector2Value = new Vector2(frame.width, frame.height);
        fields.ApplyModifiedProperties();
    }
}
