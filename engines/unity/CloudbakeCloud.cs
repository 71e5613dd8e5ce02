// cloudbake @version@: marks an object whose renderers have the shader Cloudbake/Painted as a cloud that the image chain draws.
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Rendering;

[ExecuteAlways]
[AddComponentMenu("Cloudbake/Cloud")]
public sealed class CloudbakeCloud : MonoBehaviour
{
    static readonly List<CloudbakeCloud> clouds = new List<CloudbakeCloud>();
    public static IReadOnlyList<CloudbakeCloud> All => clouds;

    [Tooltip("Over which share of its size a level of detail gives way to the next one.")]
    [Range(0, 0.5f)] public float switchBand = 0.15f;

    Renderer[] renderers = new Renderer[0];
    LOD[] levels = new LOD[0];
    float[] heights = new float[0];
    LODGroup group;

    void OnEnable()
    {
        clouds.Add(this);
        FindRenderers();
    }

    void OnDisable() => clouds.Remove(this);

    // To be called after the renderers or the levels below this object have changed.
    public void FindRenderers()
    {
        renderers = GetComponentsInChildren<Renderer>();
        group = GetComponentInChildren<LODGroup>();
        levels = group ? group.GetLODs() : new LOD[0];
        heights = new float[levels.Length];
        for (var i = 0; i < heights.Length; ++i) heights[i] = levels[i].screenRelativeTransitionHeight;
    }

    // Of the best level.
    public Bounds Box
    {
        get
        {
            var own = levels.Length > 0 ? levels[0].renderers : renderers;
            var box = new Bounds(transform.position, Vector3.zero);
            for (var i = 0; i < own.Length; ++i)
                if (i == 0) box = own[i].bounds;
                else box.Encapsulate(own[i].bounds);
            return box;
        }
    }

    public float LongestSide
    {
        get
        {
            var size = Box.size;
            return Mathf.Max(size.x, Mathf.Max(size.y, size.z));
        }
    }

    // Draws it, at the level that its size in the picture asks for; between two levels each has a share of the pixels.
    public void Draw(CommandBuffer commands, Vector3 eye, float heightAtOne)
    {
        if (levels.Length == 0)
        {
            Draw(commands, renderers, 0, 1);
            return;
        }
        var scale = group.transform.lossyScale;
        var side = group.size * Mathf.Max(Mathf.Abs(scale.x), Mathf.Max(Mathf.Abs(scale.y), Mathf.Abs(scale.z)));
        var away = (group.transform.TransformPoint(group.localReferencePoint) - eye).magnitude;
        var height = side * QualitySettings.lodBias / (Mathf.Max(away, 1e-6f) * heightAtOne);
        CloudbakeMath.Level(heights, height, switchBand, out var level, out var share);
        Draw(commands, levels[level].renderers, share, 1);
        if (share > 0) Draw(commands, levels[level + 1].renderers, 0, share);
    }

    static void Draw(CommandBuffer commands, Renderer[] all, float low, float high)
    {
        commands.SetGlobalVector("_CloudbakeShare", new Vector4(low, high, 0, 0));
        foreach (var one in all)
        {
            var materials = one.sharedMaterials;
            for (var i = 0; i < materials.Length; ++i)
            {
                var pass = materials[i] ? materials[i].FindPass("Channels") : -1;
                if (pass >= 0) commands.DrawRenderer(one, materials[i], i, pass);
            }
        }
    }
}
