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

    [MenuItem("Assets/Cloudbake/Create Material")]
    static void CreateMaterials() => ForEachGlb(path => CreateMaterial(path, "Cloudbake/Cloud"));

    [MenuItem("Assets/Cloudbake/Create Painted Material")]
    static void CreatePainted() => ForEachGlb(path => CreateMaterial(path, "Cloudbake/Painted"));

    // In the scene, from the GLB and the levels beside it.
    [MenuItem("Assets/Cloudbake/Create LOD Group")]
    static void CreateGroups() => ForEachGlb(path => CreateGroup(path, "Cloudbake/Cloud"));

    [MenuItem("Assets/Cloudbake/Create Painted LOD Group")]
    static void CreatePaintedGroups() => ForEachGlb(path => CreateGroup(path, "Cloudbake/Painted"));

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
