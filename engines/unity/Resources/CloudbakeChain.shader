// cloudbake @version@: the image chain of the painted look, a pass per step. CloudbakeChain.cs draws with it, in any render pipeline.
// The folder Resources puts it into builds, as nothing else refers to it.
Shader "Hidden/Cloudbake/Chain" {
  HLSLINCLUDE
  #pragma target 3.5
  static float4 gl_FragCoord;  // of the pixel, from the corner where images begin
  #include "glsl.hlsl"

  // One triangle that covers the screen.
  float4 vertex(uint index : SV_VertexID) : SV_POSITION {
    return float4(4.0 * float(index & 1u) - 1.0, 4.0 * float(index >> 1u) - 1.0, 0.0, 1.0);
  }
  #define CLOUDBAKE_FRAGMENT float4 fragment(float4 at : SV_POSITION) : SV_Target { gl_FragCoord = at; write(); return value; }
  ENDHLSL

  SubShader {
    Cull Off ZTest Always ZWrite Off
    Pass {
      Name "Mean"
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "mean.frag.hlsl"
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
    Pass {
      Name "Weighted"
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "weighted.frag.hlsl"
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
    Pass {
      Name "Box"
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "box.frag.hlsl"
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
    Pass {
      Name "Spread"
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "spread.frag.hlsl"
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
    Pass {
      Name "Soft"
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "soft.frag.hlsl"
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
    Pass {
      Name "Distort"
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "noise.hlsl"
      #include "channel_sum.hlsl"
      #include "distort.frag.hlsl"
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
    Pass {
      Name "Erode"
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "noise.hlsl"
      #include "view.hlsl"
      #include "erode.frag.hlsl"
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
    Pass {
      Name "Downsample"
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "channel_sum.hlsl"
      #include "downsample.frag.hlsl"
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
    Pass {
      Name "Blur"
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "channel_sum.hlsl"
      #include "blur.frag.hlsl"
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
    Pass {
      Name "DepthBlur"
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "depth_blur.frag.hlsl"
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
    Pass {
      Name "Composite"
      Blend SrcAlpha OneMinusSrcAlpha, Zero One
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #include "light.hlsl"
      #include "noise.hlsl"
      #include "soft.hlsl"
      #include "view.hlsl"
      #include "channel_sum.hlsl"
      #include "light_uniforms.hlsl"
      #include "composite.hlsl"
      #include "solid.hlsl"
      Texture2D<float4> _CameraDepthTexture;
      float4 _ZBufferParams;
      static float4 value;

      // The clouds' color, and how much of the scene they hide.
      void write() {
        int2 at = int2(gl_FragCoord.xy);
        int2 of_depth = int2(gl_FragCoord.xy * float2(textureSize(_CameraDepthTexture, 0)) / picture);
        float solid = 1.0 / (_ZBufferParams.z * texelFetch(_CameraDepthTexture, of_depth, 0).x + _ZBufferParams.w);
        float4 p = visibleChannels(at, solid);
        float4 opaque = float4(p.xy, 1.0, p.w);
        value = p.z > 0.0 ? float4(behindClouds(float3(0.0, 0.0, 0.0), opaque, at), p.z) : float4(0.0, 0.0, 0.0, 0.0);
      }
      CLOUDBAKE_FRAGMENT
      ENDHLSL
    }
  }
}
