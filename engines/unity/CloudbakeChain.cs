// cloudbake @version@: the painted look of mesh clouds: draws them into an image of light, opacity and depth, softens and stirs it, and
// puts it over the scene. CloudbakeFeature.cs (URP) and CloudbakeCamera.cs (built-in pipeline) record it for each camera. The defaults
// are those of `cloudbake preview`, or of the scene file that the kit was written with.
using System;
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Experimental.Rendering;
using UnityEngine.Rendering;

[Serializable]
public sealed class CloudbakeChain : IDisposable
{
    public enum Look { Painted, AsPublished }
    enum Pass { Mean, Weighted, Box, Spread, Soft, Distort, Erode, Downsample, Blur, DepthBlur, Composite }

    // That no setting has: of the noise of swirls and rims.
    const int SwirlOctaves = @swirl_octaves@, SwirlCells = @swirl_cells@, RimOctaves = @erosion_octaves@;
    const float SwirlGain = @swirl_gain@f, SwirlSlope = @swirl_slope@f, RimGain = @erosion_gain@f;
    const float FadingFrom = @erosion_fading_x@f, FadingTo = @erosion_fading_y@f, FarSizes = @far_sizes@f;

    public Look look = @chain_as_published@ ? Look.AsPublished : Look.Painted;
    [Tooltip("Clouds are drawn at this fraction of the picture's resolution.")]
    [Range(1, 8)] public int drawDivisor = @chain_draw_divisor@;

    [Header("Light")]
    [Tooltip("Without one it is the sun of the lighting settings.")]
    public Light sun;
    public float sunStrength = 1;
    [ColorUsage(false, true)]
    public Color ambientSky = new Color(@sky_colors_ambient_sky_x@f, @sky_colors_ambient_sky_y@f, @sky_colors_ambient_sky_z@f);
    [ColorUsage(false, true)]
    public Color ambientGround = new Color(@sky_colors_ambient_ground_x@f, @sky_colors_ambient_ground_y@f, @sky_colors_ambient_ground_z@f);
    [Range(0, 1)] public float halfLambert = @light_half_lambert@f;
    [Range(0, 1)] public float halfLambertSky = @light_half_lambert_sky@f;
    [Tooltip("Factor of the sunlight on clouds whose lobes were fitted to the volume.")]
    public float volumeGain = @light_volume_gain@f;
    [Range(0, 1)] public float phaseShare = @light_phase@f;
    [Range(0, 0.99f)] public float phaseAsymmetry = @light_phase_asymmetry@f;
    public float phaseLimit = @light_phase_limit@f;

    [Header("Depth and fog")]
    [Tooltip("World units, where the depth is 0.")]
    public float nearDistance = @chain_near_distance@f;
    [Tooltip("World units, where the depth is 1; 0: @far_sizes@ times the mean longest side of the clouds.")]
    public float farDistance = @chain_far_distance@f;
    [Tooltip("The share of fog is 1 - exp(-fogDensity * depth).")]
    public float fogDensity = @fog_density@f;
    [Tooltip("Per world unit; over 0 it replaces the fog by depth.")]
    public float distanceFog = @fog_per_unit@f;
    [ColorUsage(false, true)] public Color fogColor = new Color(@fog_color_x@f, @fog_color_y@f, @fog_color_z@f);
    [Tooltip("Strength and exponent of the light that fog scatters around the sun.")]
    public Vector2 fogScatter = new Vector2(@fog_scatter@f, @fog_scatter_exponent@f);

    [Header("Other things in the scene")]
    [Tooltip("World units before a solid thing, over which a cloud fades in.")]
    public float softDistance = 0;
    [Tooltip("World units from the eye, at which a cloud is gone, and from which it is whole.")]
    public Vector2 nearFade = Vector2.zero;
    [Tooltip("World units along the view, from which clouds fade, and at which they are gone; both 0: no fade.")]
    public Vector2 farFade = Vector2.zero;

    [Header("Swirls: lengths are heights of the picture")]
    public float tileSize = @chain_tile_size@f;
    public float farTiles = @chain_far_tiles@f;
    public float swirlStrength = @chain_swirl_strength@f;
    public float farStrength = @chain_far_strength@f;
    [Tooltip("Cycles per second.")]
    public float swirlSpeed = @chain_swirl_speed@f;
    public Vector2 nearDrift = new Vector2(@chain_near_drift_x@f, @chain_near_drift_y@f);
    public Vector2 farDrift = new Vector2(@chain_far_drift_x@f, @chain_far_drift_y@f);
    [Range(0, 1)] public float dark = @chain_dark@f;
    public int seed = @chain_seed@;

    [Header("Painted: lengths are heights of the picture")]
    public float depthSpread = @chain_depth_spread@f;
    public float nearWidth = @chain_near_width@f;
    public float farWidth = @chain_far_width@f;
    [Tooltip("Cells of the noise at rims, longest sides of a cloud.")]
    public float detailSize = @chain_detail_size@f;
    [Range(0, 0.99f)] public float detailShrink = @chain_detail_shrink@f;
    [Range(0, 1)] public float detailDarkening = @chain_detail_darkening@f;

    [Header("As published: lengths are pixels")]
    [Tooltip("The image chain has this fraction of the picture's resolution.")]
    [Range(1, 64)] public int divisor = @chain_divisor@;
    public float nearSigma = @chain_near_sigma@f;
    public float farSigma = @chain_far_sigma@f;
    public bool blurAsQuoted = @chain_blur_as_quoted@;
    [Range(0, 64)] public int depthBlurRadius = @chain_depth_blur_radius@;
    [Range(0, 64)] public int shrink = @chain_shrink@;

    [NonSerialized] readonly List<RenderTexture> images = new List<RenderTexture>();
    [NonSerialized] readonly Plane[] planes = new Plane[6];
    [NonSerialized] CommandBuffer commands;
    [NonSerialized] Material material;
    [NonSerialized] MaterialPropertyBlock values;

    // Appends all that draws the clouds of a camera over `color`, an image of width x height pixels that the scene was drawn to. The
    // depth texture of the camera must be there by then.
    public void Record(CommandBuffer into, Camera camera, RenderTargetIdentifier color, int width, int height, double seconds)
    {
        Release();
        if (CloudbakeCloud.All.Count == 0) return;
        if (!material) material = new Material(Shader.Find("Hidden/Cloudbake/Chain")) { hideFlags = HideFlags.HideAndDontSave };
        values = values ?? new MaterialPropertyBlock();
        commands = into;
        var size = MeanLongestSide();
        var range = new Vector2(nearDistance, farDistance > 0 ? farDistance : nearDistance + FarSizes * size);
        var light = sun ? sun : RenderSettings.sun;
        var toSun = light ? -light.transform.forward : Vector3.up;

        var drawn = Draw(camera, Divided(width, drawDivisor), Divided(height, drawDivisor), range, toSun);
        RenderTexture channels;
        if (look == Look.Painted)
        {
            channels = Erode(Distort(Soften(SpreadDepth(drawn)), seconds), camera, range, size);
        }
        else
        {
            drawn = Downsample(drawn, Divided(width, divisor), Divided(height, divisor));
            channels = Distort(BlurDepth(BlurByDepth(drawn)), seconds);
        }
        SetView(camera, width, height);
        SetLight(light, toSun);
        values.SetTexture("channels", channels);
        values.SetTexture("drawn", drawn);
        values.SetVector("depth_range", range);
        values.SetFloat("soft_distance", softDistance);
        values.SetVector("far_fade", farFade);
        Fill(color, Pass.Composite);
    }

    public void Dispose()
    {
        Release();
        if (material) UnityEngine.Object.DestroyImmediate(material);
    }

    // How far rims may be outside of the clouds' boxes, in heights of the picture.
    float Margin => swirlStrength + 2 * Mathf.Max(nearWidth, farWidth) + depthSpread;

    static int Divided(int pixels, int by) => (pixels + by - 1) / by;

    static float MeanLongestSide()
    {
        var sum = 0f;
        foreach (var cloud in CloudbakeCloud.All) sum += cloud.LongestSide;
        return sum / CloudbakeCloud.All.Count;
    }

    // --- The steps ---

    // Four samples a pixel, of which the mean is taken.
    RenderTexture Draw(Camera camera, int width, int height, Vector2 range, Vector3 toSun)
    {
        var eye = camera.transform.position;
        var toScreen = GL.GetGPUProjectionMatrix(camera.projectionMatrix, true) * camera.worldToCameraMatrix;
        var heightAtOne = CloudbakeMath.HeightAtOne(camera.projectionMatrix);
        var samples = Image(width, height, 4);
        commands.SetRenderTarget(samples);
        commands.ClearRenderTarget(true, true, Color.clear);
        commands.SetGlobalMatrix("_CloudbakeToScreen", toScreen);
        commands.SetGlobalVector("_CloudbakeEye", eye);
        commands.SetGlobalVector("_CloudbakeForward", camera.transform.forward);
        commands.SetGlobalVector("_CloudbakeToSun", toSun);
        commands.SetGlobalVector("_CloudbakeDepthRange", range);
        commands.SetGlobalVector("_CloudbakeNearFade", nearFade);
        commands.SetGlobalVector("_CloudbakeHalfLambert", new Vector4(halfLambert, halfLambertSky, 0, 0));
        commands.SetGlobalFloat("_CloudbakeVolumeGain", volumeGain);
        GeometryUtility.CalculateFrustumPlanes(camera, planes);
        foreach (var cloud in CloudbakeCloud.All)
            if (GeometryUtility.TestPlanesAABB(planes, CloudbakeMath.Widened(cloud.Box, eye, heightAtOne, Margin)))
                cloud.Draw(commands, eye, heightAtOne);
        values.SetTexture("sums", samples);
        values.SetFloat("share", 1);
        return Fill(Image(width, height), Pass.Mean);
    }

    RenderTexture Weighted(RenderTexture channels, bool ofDepth)
    {
        values.SetTexture("channels", channels);
        SetWhole("of_depth", ofDepth ? 1 : 0);
        return Fill(Like(channels), Pass.Weighted);
    }

    // Two boxes, along rows and along columns.
    RenderTexture Boxes(RenderTexture image, RenderTexture channels, float near, float far)
    {
        foreach (var axis in new[] { Vector2.right, Vector2.up })
        {
            values.SetTexture("image", image);
            values.SetTexture("channels", channels);
            SetWhole("axis", axis);
            values.SetFloat("near_half", near * channels.height);
            values.SetFloat("far_half", far * channels.height);
            image = Fill(Like(channels), Pass.Box);
        }
        return image;
    }

    RenderTexture SpreadDepth(RenderTexture channels)
    {
        var weighted = Boxes(Weighted(channels, true), channels, depthSpread, depthSpread);
        values.SetTexture("channels", channels);
        values.SetTexture("weighted", weighted);
        return Fill(Like(channels), Pass.Spread);
    }

    RenderTexture Soften(RenderTexture channels)
    {
        var weighted = Weighted(channels, false);
        for (var i = 0; i < 2; ++i) weighted = Boxes(weighted, channels, nearWidth, farWidth);
        values.SetTexture("channels", channels);
        values.SetTexture("weighted", weighted);
        return Fill(Like(channels), Pass.Soft);
    }

    RenderTexture Distort(RenderTexture channels, double seconds)
    {
        values.SetTexture("channels", channels);
        values.SetFloat("tile_size", tileSize);
        values.SetFloat("far_tiles", farTiles);
        values.SetFloat("swirl_strength", swirlStrength);
        values.SetFloat("far_strength", farStrength);
        values.SetVector("phases", CloudbakeMath.Phases(seconds, swirlSpeed));
        values.SetVector("drift", CloudbakeMath.Drift(seconds, swirlSpeed, nearDrift, farDrift, farTiles));
        SetWhole("seed", seed);
        SetWhole("octaves", SwirlOctaves);
        SetWhole("cells", SwirlCells);
        values.SetFloat("gain", SwirlGain);
        values.SetFloat("typical_slope", SwirlSlope);
        values.SetFloat("dark", dark);
        return Fill(Like(channels), Pass.Distort);
    }

    RenderTexture Erode(RenderTexture channels, Camera camera, Vector2 range, float size)
    {
        SetView(camera, channels.width, channels.height);
        values.SetTexture("channels", channels);
        values.SetVector("depth_range", range);
        values.SetVector("noise_origin", CloudbakeMath.Mirrored(CloudbakeCloud.All[0].transform.position));
        values.SetFloat("noise_size", detailSize * size);
        values.SetFloat("shrink", detailShrink);
        values.SetFloat("darkening", detailDarkening);
        values.SetVector("fading", new Vector2(FadingFrom, FadingTo));
        SetWhole("seed", seed);
        SetWhole("octaves", RimOctaves);
        values.SetFloat("gain", RimGain);
        return Fill(Like(channels), Pass.Erode);
    }

    RenderTexture Downsample(RenderTexture channels, int width, int height)
    {
        values.SetTexture("channels", channels);
        values.SetVector("size", new Vector2(width, height));
        return Fill(Image(width, height), Pass.Downsample);
    }

    RenderTexture BlurByDepth(RenderTexture channels)
    {
        foreach (var axis in new[] { Vector2.right, Vector2.up })
        {
            values.SetTexture("channels", channels);
            SetWhole("axis", axis);
            values.SetFloat("near_sigma", nearSigma);
            values.SetFloat("far_sigma", farSigma);
            SetWhole("as_quoted", blurAsQuoted ? 1 : 0);
            channels = Fill(Like(channels), Pass.Blur);
        }
        return channels;
    }

    RenderTexture BlurDepth(RenderTexture channels)
    {
        var sums = channels;
        foreach (var ofRows in new[] { 1, 0 })
        {
            values.SetTexture("channels", channels);
            values.SetTexture("sums", sums);
            SetWhole("radius", depthBlurRadius);
            SetWhole("shrink", shrink);
            SetWhole("of_rows", ofRows);
            sums = Fill(Like(channels), Pass.DepthBlur);
        }
        return sums;
    }

    // --- Images and values ---

    // Of whole numbers and switches, which the shader has as floats of this name.
    void SetWhole(string name, float value) => values.SetFloat(name + "_", value);
    void SetWhole(string name, Vector2 value) => values.SetVector(name + "_", value);

    // In the space of glTF, so that the noise is that of the previewer.
    void SetView(Camera camera, int width, int height)
    {
        var place = camera.transform;
        values.SetVector("eye", CloudbakeMath.Mirrored(place.position));
        values.SetVector("right", CloudbakeMath.Mirrored(place.right));
        values.SetVector("up", CloudbakeMath.Mirrored(place.up));
        values.SetVector("forward", CloudbakeMath.Mirrored(place.forward));
        values.SetVector("picture", new Vector2(width, height));
        values.SetFloat("per_pixel", CloudbakeMath.HeightAtOne(camera.projectionMatrix) / height);
    }

    void SetLight(Light light, Vector3 toSun)
    {
        values.SetVector("to_sun", CloudbakeMath.Mirrored(toSun));
        values.SetVector("sun_color", light ? light.color.linear * (light.intensity * sunStrength) : Color.white * sunStrength);
        values.SetVector("ambient_sky", ambientSky);
        values.SetVector("ambient_ground", ambientGround);
        values.SetFloat("fog_density", fogDensity);
        values.SetFloat("distance_fog", distanceFog);
        values.SetVector("fog_color", fogColor);
        values.SetVector("fog_scatter", fogScatter);
        values.SetVector("phase", new Vector3(phaseShare, phaseAsymmetry, phaseLimit));
    }

    RenderTexture Like(RenderTexture image) => Image(image.width, image.height);

    RenderTexture Image(int width, int height, int samples = 1)
    {
        var description = new RenderTextureDescriptor(width, height, GraphicsFormat.R16G16B16A16_SFloat, samples > 1 ? 32 : 0)
            { msaaSamples = samples };
        var image = RenderTexture.GetTemporary(description);
        image.filterMode = FilterMode.Point;
        images.Add(image);
        return image;
    }

    // The images of the camera before. They are kept until then, because what was recorded is drawn later.
    void Release()
    {
        foreach (var image in images) RenderTexture.ReleaseTemporary(image);
        images.Clear();
    }

    RenderTexture Fill(RenderTexture image, Pass pass)
    {
        Fill(new RenderTargetIdentifier(image), pass);
        return image;
    }

    void Fill(RenderTargetIdentifier target, Pass pass)
    {
        values.SetFloat("mean_all_", 0);
        commands.SetRenderTarget(target);
        commands.DrawProcedural(Matrix4x4.identity, material, (int)pass, MeshTopology.Triangles, 3, 1, values);
        values.Clear();
    }
}
