// cloudbake @version@: the painted look in the Universal Render Pipeline. Add it to the list of features of the renderer asset.
using UnityEngine;
using UnityEngine.Rendering;
using UnityEngine.Rendering.Universal;
#if UNITY_6000_0_OR_NEWER
using UnityEngine.Rendering.RenderGraphModule;
#endif

public sealed class CloudbakeFeature : ScriptableRendererFeature
{
    public CloudbakeChain chain = new CloudbakeChain();
    CloudsPass pass;

    // Before what is transparent.
    public override void Create() => pass = new CloudsPass { chain = chain, renderPassEvent = RenderPassEvent.AfterRenderingSkybox };

    public override void AddRenderPasses(ScriptableRenderer renderer, ref RenderingData renderingData)
    {
        var type = renderingData.cameraData.cameraType;
        if (type == CameraType.Preview || type == CameraType.Reflection) return;
        pass.ConfigureInput(ScriptableRenderPassInput.Depth);
        renderer.EnqueuePass(pass);
    }

    protected override void Dispose(bool disposing) => chain.Dispose();

    sealed class CloudsPass : ScriptableRenderPass
    {
        public CloudbakeChain chain;

#if UNITY_6000_0_OR_NEWER
        public CloudsPass() => requiresIntermediateTexture = true;

        sealed class Data
        {
            public CloudbakeChain chain;
            public Camera camera;
            public TextureHandle color;
            public int width, height;
        }

        public override void RecordRenderGraph(RenderGraph renderGraph, ContextContainer frameData)
        {
            var resources = frameData.Get<UniversalResourceData>();
            var camera = frameData.Get<UniversalCameraData>();
            using (var builder = renderGraph.AddUnsafePass<Data>("Cloudbake", out var data))
            {
                data.chain = chain;
                data.camera = camera.camera;
                data.color = resources.activeColorTexture;
                data.width = camera.cameraTargetDescriptor.width;
                data.height = camera.cameraTargetDescriptor.height;
                builder.UseTexture(data.color, AccessFlags.ReadWrite);
                builder.UseTexture(resources.cameraDepthTexture, AccessFlags.Read);
                builder.AllowPassCulling(false);
                builder.SetRenderFunc((Data own, UnsafeGraphContext context) => own.chain.Record(
                    CommandBufferHelpers.GetNativeCommandBuffer(context.cmd), own.camera, own.color, own.width, own.height,
                    Time.timeAsDouble));
            }
        }
#else
        public override void Execute(ScriptableRenderContext context, ref RenderingData renderingData)
        {
            var commands = CommandBufferPool.Get("Cloudbake");
            var data = renderingData.cameraData;
            var size = data.cameraTargetDescriptor;
            chain.Record(commands, data.camera, data.renderer.cameraColorTargetHandle, size.width, size.height, Time.timeAsDouble);
            context.ExecuteCommandBuffer(commands);
            CommandBufferPool.Release(commands);
        }
#endif
    }
}
