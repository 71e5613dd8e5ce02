// cloudbake @version@: the painted look in the built-in render pipeline. Add it to a camera.
using UnityEngine;
using UnityEngine.Rendering;

[ExecuteAlways]
[RequireComponent(typeof(Camera))]
[AddComponentMenu("Cloudbake/Camera")]
public sealed class CloudbakeCamera : MonoBehaviour
{
    // Before what is transparent.
    const CameraEvent Moment = CameraEvent.BeforeForwardAlpha;

    public CloudbakeChain chain = new CloudbakeChain();
    Camera own;
    CommandBuffer commands;

    void OnEnable()
    {
        own = GetComponent<Camera>();
        own.depthTextureMode |= DepthTextureMode.Depth;
        own.forceIntoRenderTexture = true;
        commands = new CommandBuffer { name = "Cloudbake" };
        own.AddCommandBuffer(Moment, commands);
    }

    void OnDisable()
    {
        own.RemoveCommandBuffer(Moment, commands);
        commands.Release();
        chain.Dispose();
    }

    void OnPreRender()
    {
        commands.Clear();
        chain.Record(commands, own, BuiltinRenderTextureType.CameraTarget, own.pixelWidth, own.pixelHeight, Time.timeAsDouble);
    }
}
