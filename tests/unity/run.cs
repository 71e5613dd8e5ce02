// Runs the scripts of engines/unity with the stubs of Unity, and prints what they give as JSON.
//   mono run.exe asset FILE.glb                  what CloudbakeAsset reads
//   mono run.exe levels HEIGHTS HEIGHT BAND      CloudbakeMath.Level
//   mono run.exe widened SIDE DISTANCE HEIGHT SHARE  half a side of CloudbakeMath.Widened
//   mono run.exe sequence FILE.glb SECONDS…      what CloudbakeAsset reads of a sequence, and what CloudbakeSequence shows at these times
//   mono run.exe record CASE.json                what the chain records for a camera
using System;
using System.IO;
using System.Linq;
using System.Reflection;
using UnityEngine;
using UnityEngine.Rendering;
#if CLOUDBAKE_URP
using UnityEngine.Rendering.Universal;
#endif

public static class Program
{
    [Serializable]
    public sealed class Case
    {
        public float[] eye, right, up, forward, projection, view, to_sun, sun_color, ambient_sky, ambient_ground, fog_color, origin;
        public float longest;
        public int width, height, draw_divisor;
        public double seconds;
        public bool published;
    }

    static Vector3 Vector(float[] v) => new Vector3(v[0], v[1], v[2]);
    static Color ColorOf(float[] v) => new Color(v[0], v[1], v[2]);
    static float Number(string text) => float.Parse(text, System.Globalization.CultureInfo.InvariantCulture);

    // Unity calls these, which are private.
    static void Send(object to, string message) =>
        to.GetType().GetMethod(message, BindingFlags.NonPublic | BindingFlags.Instance | BindingFlags.Public).Invoke(to, null);

    public static int Main(string[] words)
    {
        if (words[0] == "asset") Console.WriteLine(Asset(File.ReadAllBytes(words[1])));
        if (words[0] == "levels") Console.WriteLine(Level(words.Skip(1).Take(words.Length - 3).Select(Number).ToArray(),
            Number(words[words.Length - 2]), Number(words[words.Length - 1])));
        if (words[0] == "widened")
        {
            var side = Number(words[1]);
            var box = new Bounds(new Vector3(0, 0, Number(words[2])), new Vector3(side, side, side));
            var widened = CloudbakeMath.Widened(box, Vector3.zero, Number(words[3]), Number(words[4]));
            Console.WriteLine(MaterialPropertyBlock.Text(widened.extents.x));
        }
        if (words[0] == "sequence") Console.WriteLine(Sequence(File.ReadAllBytes(words[1]), words.Skip(2).Select(Number).ToArray()));
        if (words[0] == "record")
            Console.WriteLine("[" + string.Join(",\n", Record(JsonUtility.FromJson<Case>(File.ReadAllText(words[1])))) + "]");
        return 0;
    }

    static string Asset(byte[] bytes)
    {
        var lobes = CloudbakeAsset.Read(bytes);
        if (lobes == null) return "null";
        var numbers = new[] { lobes.exponent, lobes.bias, lobes.extinction, lobes.uv_sets[0], lobes.switch_pixels };
        return "{\"numbers\": " + MaterialPropertyBlock.Text(numbers)
            + ", \"fit_to\": \"" + lobes.fit_to + "\", \"fault\": \"" + CloudbakeAsset.FaultOf(lobes, 0) + "\"}";
    }

    // Of each time: the parts that are seen, each with its key, the share of the way to the next one, and its thresholds.
    static string Sequence(byte[] bytes, float[] seconds)
    {
        var info = CloudbakeAsset.Read(bytes).sequence;
        var box = CloudbakeAsset.BoxOf(CloudbakeAsset.JsonOf(bytes));
        var player = new GameObject("sequence").AddComponent<CloudbakeSequence>();
        player.framesPerSecond = info.frames_per_second;
        player.period = info.period;
        player.loops = info.loops;
        player.parts = info.segments.Select(segment => new CloudbakeSequence.Part
            { renderer = new GameObject("segment").AddComponent<Renderer>(), frames = segment.frames,
              place = new Vector4(segment.first_row, 1, segment.frames.Length, 0) }).ToArray();
        Send(player, "OnEnable");
        var shown = seconds.Select(moment =>
        {
            player.Seek(moment);
            return "[" + string.Join(", ", player.parts.Select((part, i) => part.renderer.enabled
                ? "[" + i + ", " + part.renderer.block["sequence_moment"] + ", " + part.renderer.block["_SequenceShown"] + "]" : "")
                .Where(text => text != "")) + "]";
        }).ToArray();
        return "{\"picture\": " + CloudbakeAsset.PictureOf(bytes, "keys").Length + ", \"box\": "
            + MaterialPropertyBlock.Text(box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z)
            + ", \"ends\": " + Ends(player) + ", \"shown\": [" + string.Join(", ", shown) + "]}";
    }

    // How often it begins again, and whether it plays on, after two frames that are longer than the sequence.
    static string Ends(CloudbakeSequence player)
    {
        player.loops = false;
        Time.deltaTime = (float)player.Duration * 0.75f;
        var seconds = new double[4];
        for (var i = 0; i < seconds.Length; ++i)
        {
            player.loop = i < 2;
            player.Seek(i % 2 == 0 ? 0 : player.seconds);
            player.playing = true;
            Send(player, "Update");
            seconds[i] = player.seconds / player.Duration;
        }
        return MaterialPropertyBlock.Text(seconds.Select(x => (float)x).Append(player.playing ? 1 : 0).ToArray());
    }

    static string Level(float[] heights, float height, float band)
    {
        CloudbakeMath.Level(heights, height, band, out var level, out var share);
        return MaterialPropertyBlock.Text(level, share);
    }

    static string[] Record(Case given)
    {
        var eye = new GameObject("camera");
        eye.transform.position = Vector(given.eye);
        eye.transform.right = Vector(given.right);
        eye.transform.up = Vector(given.up);
        eye.transform.forward = Vector(given.forward);
        var camera = eye.AddComponent<Camera>();
        camera.projectionMatrix = new Matrix4x4 { rows = given.projection };
        camera.worldToCameraMatrix = new Matrix4x4 { rows = given.view };
        camera.pixelWidth = given.width;
        camera.pixelHeight = given.height;
        var sun = new GameObject("sun").AddComponent<Light>();
        sun.transform.forward = -Vector(given.to_sun);
        sun.color = ColorOf(given.sun_color);
        RenderSettings.sun = sun;
        Time.timeAsDouble = given.seconds;

        var cloud = new GameObject("cloud");
        cloud.transform.position = Vector(given.origin);
        var renderer = cloud.AddComponent<Renderer>();
        renderer.bounds = new Bounds(Vector(given.origin), new Vector3(given.longest, given.longest / 2, given.longest / 2));
        renderer.sharedMaterial = new Material(Shader.Find("Cloudbake/Painted"));
        Send(cloud.AddComponent<CloudbakeCloud>(), "OnEnable");
        var chain = new CloudbakeChain
        {
            drawDivisor = given.draw_divisor, ambientSky = ColorOf(given.ambient_sky), ambientGround = ColorOf(given.ambient_ground),
            fogColor = ColorOf(given.fog_color),
        };
        if ((chain.look == CloudbakeChain.Look.AsPublished) != given.published)
            throw new Exception("the kit has not the look of its scene");
        var steps = Record(chain, camera);
        chain.Dispose();
        if (RenderTexture.taken != 0) throw new Exception(RenderTexture.taken + " images were not released");
        return steps;
    }

#if !CLOUDBAKE_URP
    static string[] Record(CloudbakeChain chain, Camera camera)
    {
        var own = camera.gameObject.AddComponent<CloudbakeCamera>();
        own.chain = chain;
        Send(own, "OnEnable");
        Send(own, "OnPreRender");
        var field = typeof(CloudbakeCamera).GetField("commands", BindingFlags.NonPublic | BindingFlags.Instance);
        var steps = ((CommandBuffer)field.GetValue(own)).steps.ToArray();
        if (!camera.forceIntoRenderTexture || camera.depthTextureMode != DepthTextureMode.Depth) throw new Exception("no depth texture");
        Send(own, "OnDisable");
        return steps;
    }
#else
    static string[] Record(CloudbakeChain chain, Camera camera)
    {
        var color = new Texture { name = "color" };
        var size = new RenderTextureDescriptor(camera.pixelWidth, camera.pixelHeight, 0, 0);
        var feature = new CloudbakeFeature { chain = chain };
        var renderer = new UniversalRenderer();
        renderer.cameraColorTargetHandle.texture = color;
        var data = new RenderingData { cameraData = new CameraData
            { camera = camera, cameraType = CameraType.Game, renderer = renderer, cameraTargetDescriptor = size } };
        feature.Create();
        feature.AddRenderPasses(renderer, ref data);
#if UNITY_6000_0_OR_NEWER
        var frame = new ContextContainer();
        var handle = new UnityEngine.Rendering.RenderGraphModule.TextureHandle { texture = color };
        frame.items.Add(new UniversalResourceData { activeColorTexture = handle, cameraDepthTexture = handle });
        frame.items.Add(new UniversalCameraData { camera = camera, cameraTargetDescriptor = size });
        renderer.pass.RecordRenderGraph(new UnityEngine.Rendering.RenderGraphModule.RenderGraph(), frame);
        return UnityEngine.Rendering.RenderGraphModule.RenderGraph.steps.ToArray();
#else
        renderer.pass.Execute(new ScriptableRenderContext(), ref data);
        return ScriptableRenderContext.steps.ToArray();
#endif
    }
#endif
}
