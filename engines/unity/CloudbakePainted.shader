// cloudbake @version@: a mesh cloud that the image chain draws (CloudbakeChain.cs): its light of sun and sky, where it is, and how far.
// Nothing else draws it. In any render pipeline. The lobes must be in the mesh's UV sets @first_set@ and @second_set@.
Shader "Cloudbake/Painted" {
  Properties {
    [Header(From the asset)]
    _Exponent ("Exponent k", Float) = @exponent@
    _Bias ("Bias b, world units", Float) = @bias@
    _Extinction ("Extinction sigma, per world unit", Float) = @extinction@
    _DensityMax ("Largest d of a packed asset, else 0", Float) = @density_max@
    [Toggle] _OfVolume ("The lobes were fitted to the volume", Float) = 0
  }
  SubShader {
    Tags { "RenderType" = "Opaque" "Queue" = "Geometry" }
    Pass {
      Name "Channels"
      Tags { "LightMode" = "CloudbakeChannels" }
      Cull Off ZTest LEqual ZWrite On
      HLSLPROGRAM
      #pragma target 3.5
      #pragma vertex vertex
      #pragma fragment fragment
      #include "UnityCG.cginc"
      #include "CloudbakeLobe.hlsl"
      #include "channels.hlsl"

      float _Exponent, _Bias, _Extinction, _DensityMax, _OfVolume;
      // Of the chain.
      float4x4 _CloudbakeToScreen;
      float3 _CloudbakeEye, _CloudbakeForward, _CloudbakeToSun;
      float2 _CloudbakeDepthRange, _CloudbakeNearFade;
      float2 _CloudbakeHalfLambert;  // of sun and sky
      float _CloudbakeVolumeGain;
      float2 _CloudbakeShare;  // of the pixels, from and to: two levels of detail share them

      struct Attributes {
        float4 position : POSITION;
        float3 normal : NORMAL;
        float2 first : TEXCOORD@first_set@;
        float2 second : TEXCOORD@second_set@;
      };
      struct Varyings {
        float4 position : SV_POSITION;
        float2 light : TEXCOORD0;  // the shares of sun and sky
        float3 from_eye : TEXCOORD1;
      };

      Varyings vertex(Attributes input) {
        float2 light;
        CloudbakePackedLight_float(input.first, input.second, _CloudbakeToSun, _Exponent, _Bias, _Extinction, _DensityMax, light.x,
                                   light.y);
        light.x = min(light.x * lerp(1.0, _CloudbakeVolumeGain, _OfVolume), 1.0);
        float3 normal = UnityObjectToWorldNormal(input.normal);
        float3 place = mul(unity_ObjectToWorld, float4(input.position.xyz, 1.0)).xyz;
        Varyings output;
        output.position = mul(_CloudbakeToScreen, float4(place, 1.0));
        output.light.x = light.x * surfaceFactor(normal, _CloudbakeToSun, _CloudbakeHalfLambert.x);
        output.light.y = light.y * surfaceFactor(normal, float3(0.0, 1.0, 0.0), _CloudbakeHalfLambert.y);
        output.from_eye = place - _CloudbakeEye;
        return output;
      }

      // As a share of the pixels near the eye is left out, what is behind the cloud shows through.
      float4 fragment(Varyings input) : SV_Target {
        float of_level = ditherThreshold(input.position.xy + 32.0);
        if (of_level < _CloudbakeShare.x || of_level >= _CloudbakeShare.y) discard;
        float whole = fadeBetween(length(input.from_eye), _CloudbakeNearFade.x, _CloudbakeNearFade.y);
        if (whole <= ditherThreshold(input.position.xy)) discard;
        return channelsOf(input.light, dot(input.from_eye, _CloudbakeForward), _CloudbakeDepthRange);
      }
      ENDHLSL
    }
  }
}
