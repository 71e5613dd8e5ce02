// What the scripts of engines/unity use of Unity's public API (docs.unity3d.com/ScriptReference), so that a compiler can check them and
// they can run without Unity. A command buffer keeps what it is given, as JSON.
using System;
using System.Collections.Generic;
using System.Globalization;
using System.Linq;
using System.Runtime.Serialization.Json;
using System.Text;
using System.Xml;

namespace UnityEngine
{
    public struct Vector2
    {
        public float x, y;
        public Vector2(float x, float y) { this.x = x; this.y = y; }
        public static Vector2 zero => new Vector2(0, 0);
        public static Vector2 right => new Vector2(1, 0);
        public static Vector2 up => new Vector2(0, 1);
        public static implicit operator Vector4(Vector2 v) => new Vector4(v.x, v.y, 0, 0);
    }

    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
        public static Vector3 zero => new Vector3(0, 0, 0);
        public static Vector3 up => new Vector3(0, 1, 0);
        public float magnitude => (float)Math.Sqrt(x * x + y * y + z * z);
        public static Vector3 operator -(Vector3 a) => new Vector3(-a.x, -a.y, -a.z);
        public static Vector3 operator +(Vector3 a, Vector3 b) => new Vector3(a.x + b.x, a.y + b.y, a.z + b.z);
        public static Vector3 operator -(Vector3 a, Vector3 b) => new Vector3(a.x - b.x, a.y - b.y, a.z - b.z);
        public static Vector3 operator *(Vector3 a, float b) => new Vector3(a.x * b, a.y * b, a.z * b);
        public static implicit operator Vector4(Vector3 v) => new Vector4(v.x, v.y, v.z, 0);
    }

    public struct Vector4
    {
        public float x, y, z, w;
        public Vector4(float x, float y, float z, float w) { this.x = x; this.y = y; this.z = z; this.w = w; }
        public static bool operator ==(Vector4 a, Vector4 b) => a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
        public static bool operator !=(Vector4 a, Vector4 b) => !(a == b);
        public override bool Equals(object other) => other is Vector4 v && this == v;
        public override int GetHashCode() => x.GetHashCode();
    }

    public struct Color
    {
        public float r, g, b, a;
        public Color(float r, float g, float b) { this.r = r; this.g = g; this.b = b; a = 1; }
        public Color(float r, float g, float b, float a) { this.r = r; this.g = g; this.b = b; this.a = a; }
        public static Color white => new Color(1, 1, 1);
        public static Color clear => new Color(0, 0, 0, 0);
        public Color linear => this;  // the tests give linear ones
        public static Color operator *(Color a, float b) => new Color(a.r * b, a.g * b, a.b * b, a.a * b);
        public static implicit operator Vector4(Color c) => new Vector4(c.r, c.g, c.b, c.a);
    }

    public struct Quaternion
    {
        public static Quaternion LookRotation(Vector3 forward, Vector3 upwards) => new Quaternion();
    }

    public struct Matrix4x4
    {
        public float[] rows;
        public float m11 => rows[5];
        public static Matrix4x4 identity => new Matrix4x4 { rows = new float[] { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
        public static Matrix4x4 operator *(Matrix4x4 a, Matrix4x4 b)
        {
            var product = new float[16];
            for (var i = 0; i < 16; ++i)
                for (var k = 0; k < 4; ++k) product[i] += a.rows[i / 4 * 4 + k] * b.rows[4 * k + i % 4];
            return new Matrix4x4 { rows = product };
        }
    }

    public struct Bounds
    {
        public Vector3 center, extents;
        public Bounds(Vector3 center, Vector3 size) { this.center = center; extents = size * 0.5f; }
        public Vector3 size => extents * 2;
        public Vector3 min => center - extents;
        public Vector3 max => center + extents;
        public void Expand(float amount) => extents += new Vector3(amount, amount, amount) * 0.5f;
        public void Encapsulate(Bounds other)
        {
            var low = new Vector3(Math.Min(min.x, other.min.x), Math.Min(min.y, other.min.y), Math.Min(min.z, other.min.z));
            var high = new Vector3(Math.Max(max.x, other.max.x), Math.Max(max.y, other.max.y), Math.Max(max.z, other.max.z));
            center = (low + high) * 0.5f;
            extents = (high - low) * 0.5f;
        }
    }

    public struct Plane { }

    public static class Mathf
    {
        public static float Abs(float x) => Math.Abs(x);
        public static float Max(float a, float b) => Math.Max(a, b);
        public static float Clamp(float x, float low, float high) => Math.Max(low, Math.Min(high, x));
    }

    public class Object
    {
        public string name = "";
        public HideFlags hideFlags;
        public static implicit operator bool(Object one) => one != null;
        public static void DestroyImmediate(Object one) { }
        public static T Instantiate<T>(T original, Transform parent) where T : Object => original;
    }
    [Flags] public enum HideFlags { None, HideAndDontSave = 61 }

    public class Component : Object
    {
        public GameObject gameObject;
        public Transform transform => gameObject.transform;
        public T GetComponent<T>() where T : class => gameObject.GetComponent<T>();
        public Component GetComponent(string type) => gameObject.components.FirstOrDefault(one => one.GetType().Name == type);
        public T GetComponentInChildren<T>() where T : class => GetComponentsInChildren<T>().FirstOrDefault();
        public T[] GetComponentsInChildren<T>(bool includeInactive = false) where T : class => gameObject.GetComponentsInChildren<T>();
    }

    public class GameObject : Object
    {
        public readonly List<Component> components = new List<Component>();
        public readonly List<GameObject> children = new List<GameObject>();
        public readonly Transform transform;
        public GameObject() : this("") { }
        public GameObject(string name) { this.name = name; transform = new Transform { gameObject = this }; }
        public T AddComponent<T>() where T : Component, new()
        {
            var made = new T { gameObject = this };
            components.Add(made);
            return made;
        }
        public T GetComponent<T>() where T : class => components.OfType<T>().FirstOrDefault();
        public T[] GetComponentsInChildren<T>(bool includeInactive = false) where T : class =>
            components.OfType<T>().Concat(children.SelectMany(child => child.GetComponentsInChildren<T>())).ToArray();
    }

    public class Transform : Component
    {
        public Vector3 position, right = new Vector3(1, 0, 0), up = Vector3.up, forward = new Vector3(0, 0, 1);
        public Transform parent;
        public Vector3 lossyScale = new Vector3(1, 1, 1), localScale = new Vector3(1, 1, 1);
        public Quaternion rotation;
        public Vector3 TransformPoint(Vector3 own) => position + own;
    }

    public class Behaviour : Component { }
    public class MonoBehaviour : Behaviour { }
    public class ScriptableObject : Object { }

    public class Renderer : Component
    {
        public Bounds bounds, localBounds;
        public Material[] sharedMaterials = new Material[0];
        public Material sharedMaterial { set { sharedMaterials = new[] { value }; } }
        public bool enabled = true;
        public Dictionary<string, string> block = new Dictionary<string, string>();
        public void SetPropertyBlock(MaterialPropertyBlock properties) => block = new Dictionary<string, string>(properties.values);
    }

    public struct LOD
    {
        public float screenRelativeTransitionHeight, fadeTransitionWidth;
        public Renderer[] renderers;
        public LOD(float screenRelativeTransitionHeight, Renderer[] renderers)
        {
            this.screenRelativeTransitionHeight = screenRelativeTransitionHeight;
            this.renderers = renderers;
            fadeTransitionWidth = 0;
        }
    }
    public enum LODFadeMode { None, CrossFade, SpeedTree }
    public class LODGroup : Component
    {
        LOD[] levels = new LOD[0];
        public float size = 1;
        public Vector3 localReferencePoint;
        public LODFadeMode fadeMode;
        public LOD[] GetLODs() => levels;
        public void SetLODs(LOD[] lods) => levels = lods;
        public void RecalculateBounds() { }
    }
    public static class QualitySettings { public static float lodBias = 1; }

    public class Light : Behaviour
    {
        public Color color = Color.white;
        public float intensity = 1, cookieSize;
        public Texture cookie;
    }
    public static class RenderSettings { public static Light sun; }

    public enum CameraType { Game = 1, SceneView = 2, Preview = 4, VR = 8, Reflection = 16 }
    [Flags] public enum DepthTextureMode { None, Depth }
    public class Camera : Behaviour
    {
        public Matrix4x4 projectionMatrix = Matrix4x4.identity, worldToCameraMatrix = Matrix4x4.identity;
        public DepthTextureMode depthTextureMode;
        public bool forceIntoRenderTexture;
        public int pixelWidth = 1, pixelHeight = 1;
        public void AddCommandBuffer(Rendering.CameraEvent moment, Rendering.CommandBuffer buffer) { }
        public void RemoveCommandBuffer(Rendering.CameraEvent moment, Rendering.CommandBuffer buffer) { }
    }
    public static class GL { public static Matrix4x4 GetGPUProjectionMatrix(Matrix4x4 proj, bool renderIntoTexture) => proj; }
    public static class GeometryUtility
    {
        public static Func<Bounds, bool> isSeen = box => true;
        public static void CalculateFrustumPlanes(Camera camera, Plane[] planes) { }
        public static bool TestPlanesAABB(Plane[] planes, Bounds bounds) => isSeen(bounds);
    }
    public static class Time { public static double timeAsDouble; public static float deltaTime; }
    public static class Application { public static bool isPlaying = true; }

    public class Shader : Object
    {
        public static Shader Find(string name) => new Shader { name = name };
    }
    public class Material : Object
    {
        public readonly Shader shader;
        public readonly Dictionary<string, float> floats = new Dictionary<string, float>();
        public bool enableInstancing;
        public Material(Shader shader) { this.shader = shader; }
        public int FindPass(string passName) => shader.name == "Cloudbake/Painted" && passName == "Channels" ? 0 : -1;
        public bool HasProperty(string name) => true;
        public void SetFloat(string name, float value) => floats[name] = value;
        public void SetVector(string name, Vector4 value) { }
        public void SetTexture(string name, Texture value) { }
        public void EnableKeyword(string keyword) { }
    }
    public class Mesh : Object { public int vertexCount = 0; }
    public class MeshFilter : Component { public Mesh sharedMesh = new Mesh(); }

    public class Texture : Object
    {
        public int width, height;
        public FilterMode filterMode;
    }
    public class Texture2D : Texture { }
    public enum FilterMode { Point, Bilinear, Trilinear }
    public enum TextureWrapMode { Repeat, Clamp }
    public struct RenderTextureDescriptor
    {
        public int width, height, depthBufferBits, msaaSamples;
        public RenderTextureDescriptor(int width, int height, Experimental.Rendering.GraphicsFormat colorFormat, int depthBufferBits)
        {
            this.width = width;
            this.height = height;
            this.depthBufferBits = depthBufferBits;
            msaaSamples = 1;
        }
    }
    public class RenderTexture : Texture
    {
        public int samples;
        static int made;
        public static int taken;
        public static RenderTexture GetTemporary(RenderTextureDescriptor desc)
        {
            ++taken;
            return new RenderTexture { name = "image " + ++made, width = desc.width, height = desc.height, samples = desc.msaaSamples };
        }
        public static void ReleaseTemporary(RenderTexture temp) => --taken;
    }
    public enum MeshTopology { Triangles }

    public class MaterialPropertyBlock
    {
        public readonly Dictionary<string, string> values = new Dictionary<string, string>();
        public static string Text(params float[] numbers) =>
            "[" + string.Join(", ", numbers.Select(number => number.ToString("R", CultureInfo.InvariantCulture))) + "]";
        public void SetFloat(string name, float value) => values[name] = Text(value);
        public void SetVector(string name, Vector4 value) => values[name] = Text(value.x, value.y, value.z, value.w);
        public void SetTexture(string name, Texture value) => values[name] = "\"" + value.name + "\"";
        public void Clear() => values.Clear();
    }

    // As Unity's: fields that the text has not keep what they are, and what no field is for is ignored.
    public static class JsonUtility
    {
        public static T FromJson<T>(string json)
        {
            var document = new XmlDocument();
            var quotas = new XmlDictionaryReaderQuotas { MaxStringContentLength = int.MaxValue, MaxArrayLength = int.MaxValue };
            document.Load(JsonReaderWriterFactory.CreateJsonReader(Encoding.UTF8.GetBytes(json), quotas));
            return (T)Value(typeof(T), document.DocumentElement);
        }

        static object Value(Type type, XmlNode node)
        {
            if (node.Attributes["type"].Value == "null") return null;
            if (type == typeof(string)) return node.InnerText;
            if (type == typeof(bool)) return node.InnerText == "true";
            if (type.IsPrimitive) return Convert.ChangeType(node.InnerText, type, CultureInfo.InvariantCulture);
            if (type.IsArray)
            {
                var array = Array.CreateInstance(type.GetElementType(), node.ChildNodes.Count);
                for (var i = 0; i < array.Length; ++i) array.SetValue(Value(type.GetElementType(), node.ChildNodes[i]), i);
                return array;
            }
            var made = Activator.CreateInstance(type);
            foreach (var field in type.GetFields())
                if (node[field.Name] != null) field.SetValue(made, Value(field.FieldType, node[field.Name]));
            return made;
        }
    }
    public static class Debug { public static void LogError(object message) => Console.Error.WriteLine(message); }

    [AttributeUsage(AttributeTargets.Field)] public class TooltipAttribute : Attribute { public TooltipAttribute(string tooltip) { } }
    [AttributeUsage(AttributeTargets.Field, AllowMultiple = true)]
    public class HeaderAttribute : Attribute { public HeaderAttribute(string header) { } }
    [AttributeUsage(AttributeTargets.Field)] public class RangeAttribute : Attribute { public RangeAttribute(float min, float max) { } }
    [AttributeUsage(AttributeTargets.Field)]
    public class ColorUsageAttribute : Attribute { public ColorUsageAttribute(bool showAlpha, bool hdr) { } }
    public class ExecuteAlways : Attribute { }
    public class AddComponentMenu : Attribute { public AddComponentMenu(string menuName) { } }
    public class RequireComponent : Attribute { public RequireComponent(Type requiredComponent) { } }
}

namespace UnityEngine.Experimental.Rendering
{
    public enum GraphicsFormat { R16G16B16A16_SFloat = 48 }
}

namespace UnityEngine.Rendering
{
    public enum CameraEvent { BeforeForwardAlpha = 18 }
    public enum BuiltinRenderTextureType { CameraTarget = 2 }
    public struct RenderTargetIdentifier
    {
        public string name;
        public int width, height;
        public RenderTargetIdentifier(Texture texture) { name = texture.name; width = texture.width; height = texture.height; }
        public static implicit operator RenderTargetIdentifier(Texture texture) => new RenderTargetIdentifier(texture);
        public static implicit operator RenderTargetIdentifier(BuiltinRenderTextureType type) =>
            new RenderTargetIdentifier { name = "color" };
    }

    public class CommandBuffer
    {
        public string name = "";
        public readonly List<string> steps = new List<string>();
        string target = "";
        public void Clear() => steps.Clear();
        public void Release() { }
        public void SetRenderTarget(RenderTargetIdentifier rt) =>
            target = "\"target\": \"" + rt.name + "\", \"width\": " + rt.width + ", \"height\": " + rt.height;
        public void ClearRenderTarget(bool clearDepth, bool clearColor, Color backgroundColor) =>
            steps.Add("{\"clear\": true, " + target + "}");
        public void SetGlobalMatrix(string name, Matrix4x4 value) => Global(name, MaterialPropertyBlock.Text(value.rows));
        public void SetGlobalVector(string name, Vector4 value) =>
            Global(name, MaterialPropertyBlock.Text(value.x, value.y, value.z, value.w));
        public void SetGlobalFloat(string name, float value) => Global(name, MaterialPropertyBlock.Text(value));
        void Global(string name, string value) => steps.Add("{\"global\": \"" + name + "\", \"value\": " + value + "}");
        public void DrawRenderer(Renderer renderer, Material material, int submeshIndex, int shaderPass) =>
            steps.Add("{\"renderer\": \"" + renderer.gameObject.name + "\", " + target + "}");
        public void DrawProcedural(Matrix4x4 matrix, Material material, int shaderPass, MeshTopology topology, int vertexCount,
                                   int instanceCount, MaterialPropertyBlock properties) =>
            steps.Add("{\"pass\": " + shaderPass + ", " + target + ", \"values\": {"
                + string.Join(", ", properties.values.Select(one => "\"" + one.Key + "\": " + one.Value)) + "}}");
    }
}

namespace UnityEditor
{
    using UnityEngine;

    [AttributeUsage(AttributeTargets.Method)] public class MenuItem : Attribute { public MenuItem(string itemName) { } }
    public static class Selection { public static Object[] objects = new Object[0]; }
    public static class AssetDatabase
    {
        public static string GetAssetPath(Object asset) => asset.name;
        public static void SaveAssets() { }
        public static void CreateAsset(Object asset, string path) { }
        public static void ImportAsset(string path) { }
        public static string GenerateUniqueAssetPath(string path) => path;
        public static T LoadAssetAtPath<T>(string assetPath) where T : Object, new() => new T { name = assetPath };
    }
    public static class PrefabUtility
    {
        public static Object InstantiatePrefab(Object prefab, Transform parent)
        {
            var made = new GameObject(prefab.name);
            made.AddComponent<Renderer>();
            if (parent) parent.gameObject.children.Add(made);
            return made;
        }
    }
    public static class Undo
    {
        public static void RegisterCreatedObjectUndo(Object objectToUndo, string name) { }
        public static void RecordObjects(Object[] objectsToUndo, string name) { }
    }
    public enum TextureImporterType { Default, Cookie = 4 }
    public enum TextureImporterAlphaSource { None, FromInput, FromGrayScale }
    public class AssetImporter : Object
    {
        public static AssetImporter GetAtPath(string path) => new TextureImporter();
        public void SaveAndReimport() { }
    }
    public class TextureImporter : AssetImporter
    {
        public TextureImporterType textureType;
        public TextureImporterAlphaSource alphaSource;
        public bool sRGBTexture;
        public TextureWrapMode wrapMode;
        public bool mipmapEnabled;
        public int maxTextureSize;
        public FilterMode filterMode;
        public TextureImporterNPOTScale npotScale;
        public TextureImporterCompression textureCompression;
    }
    public enum TextureImporterNPOTScale { None }
    public enum TextureImporterCompression { Uncompressed }
    public class SerializedObject
    {
        public SerializedObject(Object target) { }
        public SerializedProperty FindProperty(string propertyPath) => new SerializedProperty();
        public bool ApplyModifiedProperties() => true;
    }
    public class SerializedProperty { public Vector2 vector2Value; }
}

#if CLOUDBAKE_URP
namespace UnityEngine.Rendering
{
    public class RTHandle
    {
        public Texture texture;
        public static implicit operator RenderTargetIdentifier(RTHandle handle) => new RenderTargetIdentifier(handle.texture);
    }
    public static class CommandBufferPool
    {
        public static readonly List<CommandBuffer> released = new List<CommandBuffer>();
        public static CommandBuffer Get(string name) => new CommandBuffer { name = name };
        public static void Release(CommandBuffer buffer) => released.Add(buffer);
    }
    public struct ScriptableRenderContext
    {
        public static readonly List<string> steps = new List<string>();
        public void ExecuteCommandBuffer(CommandBuffer commandBuffer) => steps.AddRange(commandBuffer.steps);
    }
}

namespace UnityEngine.Rendering.Universal
{
    public enum RenderPassEvent { AfterRenderingSkybox = 400 }
    [Flags] public enum ScriptableRenderPassInput { None, Depth }
    public abstract class ScriptableRenderer
    {
        public ScriptableRenderPass pass;
        public RTHandle cameraColorTargetHandle = new RTHandle();
        public void EnqueuePass(ScriptableRenderPass pass) => this.pass = pass;
    }
    public class UniversalRenderer : ScriptableRenderer { }
    public struct CameraData
    {
        public Camera camera;
        public CameraType cameraType;
        public ScriptableRenderer renderer;
        public RenderTextureDescriptor cameraTargetDescriptor;
    }
    public struct RenderingData { public CameraData cameraData; }
    public abstract class ScriptableRendererFeature : ScriptableObject
    {
        public abstract void Create();
        public abstract void AddRenderPasses(ScriptableRenderer renderer, ref RenderingData renderingData);
        protected virtual void Dispose(bool disposing) { }
    }
    public abstract class ScriptableRenderPass
    {
        public RenderPassEvent renderPassEvent { get; set; }
        public void ConfigureInput(ScriptableRenderPassInput passInput) { }
#if UNITY_6000_0_OR_NEWER
        public bool requiresIntermediateTexture { get; set; }
        [Obsolete] public virtual void Execute(ScriptableRenderContext context, ref RenderingData renderingData) { }
        public virtual void RecordRenderGraph(RenderGraphModule.RenderGraph renderGraph, ContextContainer frameData) { }
#else
        public abstract void Execute(ScriptableRenderContext context, ref RenderingData renderingData);
#endif
    }
#if UNITY_6000_0_OR_NEWER
    public class UniversalResourceData : ContextItem
    {
        public RenderGraphModule.TextureHandle activeColorTexture, cameraDepthTexture;
    }
    public class UniversalCameraData : ContextItem
    {
        public Camera camera;
        public RenderTextureDescriptor cameraTargetDescriptor;
    }
#endif
}
#if UNITY_6000_0_OR_NEWER
namespace UnityEngine.Rendering
{
    public abstract class ContextItem { }
    public class ContextContainer
    {
        public readonly List<ContextItem> items = new List<ContextItem>();
        public T Get<T>() where T : ContextItem, new() => items.OfType<T>().First();
    }
    public class UnsafeCommandBuffer { public readonly CommandBuffer native = new CommandBuffer(); }
    public static class CommandBufferHelpers
    {
        public static CommandBuffer GetNativeCommandBuffer(UnsafeCommandBuffer rasterBuffer) => rasterBuffer.native;
    }
}
namespace UnityEngine.Rendering.RenderGraphModule
{
    [Flags] public enum AccessFlags { None, Read, Write, ReadWrite = 3 }
    public struct TextureHandle
    {
        public Texture texture;
        public static implicit operator RenderTargetIdentifier(TextureHandle handle) => new RenderTargetIdentifier(handle.texture);
    }
    public class UnsafeGraphContext { public UnsafeCommandBuffer cmd = new UnsafeCommandBuffer(); }
    public delegate void BaseRenderFunc<PassData, ContextType>(PassData data, ContextType renderGraphContext) where PassData : class, new();
    public interface IUnsafeRenderGraphBuilder : IDisposable
    {
        void UseTexture(in TextureHandle input, AccessFlags flags);
        void AllowPassCulling(bool value);
        void SetRenderFunc<PassData>(BaseRenderFunc<PassData, UnsafeGraphContext> renderFunc) where PassData : class, new();
    }
    public class RenderGraph
    {
        public static readonly List<string> steps = new List<string>();
        sealed class Builder : IUnsafeRenderGraphBuilder
        {
            public object data;
            public void UseTexture(in TextureHandle input, AccessFlags flags) { }
            public void AllowPassCulling(bool value) { }
            public void SetRenderFunc<PassData>(BaseRenderFunc<PassData, UnsafeGraphContext> renderFunc) where PassData : class, new()
            {
                var context = new UnsafeGraphContext();
                renderFunc((PassData)data, context);
                steps.AddRange(context.cmd.native.steps);
            }
            public void Dispose() { }
        }
        public IUnsafeRenderGraphBuilder AddUnsafePass<PassData>(string passName, out PassData passData) where PassData : class, new()
        {
            passData = new PassData();
            return new Builder { data = passData };
        }
    }
}
#endif
#endif
