// cloudbake @version@: a mesh cloud in Unity, lit by the main light, by lamps and the sky through its lobes, without passes after it: in
// the Universal Render Pipeline and in the built-in one. The lobes must be in the mesh's UV sets @first_set@ and @second_set@.
Shader "Cloudbake/Cloud" {
  Properties {
    [Header(From the asset)]
    _Exponent ("Exponent k", Float) = @exponent@
    _Bias ("Bias b, world units", Float) = @bias@
    _Extinction ("Extinction sigma, per world unit", Float) = @extinction@
    _DensityMax ("Largest d of a packed asset, else 0", Float) = @density_max@
    [Header(Light)]
    _SunStrength ("Strength of the main light", Float) = 1
    _AmbientSky ("Light of the sky", Color) = (0.32, 0.42, 0.62, 1)
    _AmbientGround ("Light in the shadow", Color) = (0.16, 0.17, 0.21, 1)
    _HalfLambert ("Half-Lambert: 1 is the lobe alone", Range(0, 1)) = 1
    [Header(Phase)]
    _PhaseShare ("Share: 0 is without", Range(0, 1)) = 0
    _PhaseAsymmetry ("Asymmetry g", Range(0, 0.95)) = 0.6
    _PhaseLimit ("Limit", Float) = 4
    [Header(Soft rims)]
    _RimStart ("Facing where the surface begins", Range(0, 1)) = 0
    _RimEnd ("Facing where it is whole: 0 is a hard rim", Range(0, 1)) = 0
    _RimFrequency ("Noise at the rim, cells per unit of the object", Float) = 12
    _RimScroll ("Cells that the noise moves in a second", Vector) = (0.2, 0.1, 0, 0)
    [Toggle] _AlphaToMask ("By the samples of MSAA, not by dither", Float) = 0
    [Header(Other things)]
    _SoftDistance ("Before solid things, over which it fades in", Float) = 0
    _NearFade ("Distances where it is gone, and whole", Vector) = (0, 0, 0, 0)
    _FarFade ("Distances where it fades, and is gone", Vector) = (0, 0, 0, 0)
    [Header(Of a sequence)]
    [Toggle(CLOUDBAKE_SEQUENCE)] _Sequence ("It is a sequence", Float) = 0
    [NoScaleOffset] sequence_keys ("Its keys, linear", 2D) = "black" {}
    sequence_low ("Lowest corner of its box", Vector) = (0, 0, 0, 0)
    sequence_high ("Highest corner of its box", Vector) = (0, 0, 0, 0)
    sequence_densest ("Largest d", Float) = 0
    [HideInInspector] sequence_place ("", Vector) = (0, 1, 1, 0)
    [HideInInspector] sequence_moment ("", Vector) = (0, 0, 0, 0)
    [HideInInspector] _SequenceShown ("", Vector) = (0, 1, 0, 0)
  }

  SubShader {
    PackageRequirements { "com.unity.render-pipelines.universal": "14.0" }
    Tags { "RenderPipeline" = "UniversalPipeline" "RenderType" = "TransparentCutout" "Queue" = "Transparent-400" }
    Pass {
      Tags { "LightMode" = "UniversalForward" }
      ZWrite On
      AlphaToMask [_AlphaToMask]
      HLSLPROGRAM
      #pragma target 3.5
      #pragma vertex vertex
      #pragma fragment fragment
      #pragma multi_compile_instancing
      #pragma multi_compile_fog
      #pragma multi_compile _ LOD_FADE_CROSSFADE
      #pragma shader_feature_local CLOUDBAKE_SEQUENCE
      #pragma multi_compile _ _ADDITIONAL_LIGHTS_VERTEX _ADDITIONAL_LIGHTS
      #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Core.hlsl"
      #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Lighting.hlsl"
      #include "CloudbakeLook.hlsl"

      struct Attributes {
        float3 position : POSITION;
        float3 normal : NORMAL;
#ifdef CLOUDBAKE_SEQUENCE
        float2 texel : TEXCOORD2;
#else
        float2 first : TEXCOORD@first_set@;
        float2 second : TEXCOORD@second_set@;
#endif
        UNITY_VERTEX_INPUT_INSTANCE_ID
      };
      struct Varyings {
        float4 position : SV_POSITION;
        float2 light : TEXCOORD0;  // the shares of sun and sky
        float4 world : TEXCOORD1;  // and the fog
        float3 own : TEXCOORD2;    // in the object's space
        float3 normal : TEXCOORD3;
        float3 lamps : TEXCOORD4;
        UNITY_VERTEX_INPUT_INSTANCE_ID
      };

      // The light of lamps, per vertex.
      float3 lampsAt(float4 lobe, float3 place, float3 normal) {
        float3 sum = float3(0.0, 0.0, 0.0);
#if defined(_ADDITIONAL_LIGHTS_VERTEX) || defined(_ADDITIONAL_LIGHTS)
        uint count = GetAdditionalLightsCount();
        for (uint i = 0u; i < count; ++i) {
          Light lamp = GetAdditionalLight(i, place);
          // Its place, from its direction and how far it is; that of a directional light is far away.
          float4 at = _AdditionalLightsPosition[GetPerObjectLightIndex(i)];
          float3 lamp_place = at.w > 0.0 ? at.xyz : place + 1e3 * at.xyz;
          sum += lampShare(lamp_place, lamp.color * lamp.distanceAttenuation, lobe, place, normal);
        }
#endif
        return sum;
      }

      Varyings vertex(Attributes input) {
        UNITY_SETUP_INSTANCE_ID(input);
        Varyings output = (Varyings)0;
        UNITY_TRANSFER_INSTANCE_ID(input, output);
#ifdef CLOUDBAKE_SEQUENCE
        float4 lobe = worldVertex(input.texel, input.position, input.normal);
#else
        float4 lobe = worldLobe(input.first, input.second);
#endif
        float3 place = TransformObjectToWorld(input.position);
        output.normal = TransformObjectToWorldNormal(input.normal);
        output.light = sunAndSky(lobe, output.normal, GetMainLight().direction);
        output.lamps = lampsAt(lobe, place, output.normal);
        output.own = input.position;
        output.position = TransformWorldToHClip(place);
        output.world = float4(place, ComputeFogFactor(output.position.z));
        return output;
      }

      half4 fragment(Varyings input) : SV_Target {
        UNITY_SETUP_INSTANCE_ID(input);
        Light sun = GetMainLight();
        float3 from_eye = input.world.xyz - GetCameraPositionWS();
        float along = -TransformWorldToView(input.world.xyz).z;
        float opacity = opacityAt(input.position, input.own, input.normal, from_eye, along, _ZBufferParams);
        leaveOut(input.position, opacity, unity_LODFade.x);
        float factor = _SunStrength * phaseFactor(normalize(from_eye), sun.direction, _PhaseShare, _PhaseAsymmetry, _PhaseLimit);
        float3 color = cloudColor(input.light.x, input.light.y, factor * sun.color, _AmbientSky.rgb, _AmbientGround.rgb) + input.lamps;
        return half4(MixFog(color, input.world.w), _AlphaToMask > 0.5 ? opacity : 1.0);
      }
      ENDHLSL
    }
  }

  SubShader {
    Tags { "RenderType" = "TransparentCutout" "Queue" = "Transparent-400" }
    CGINCLUDE
    #pragma target 3.5
    #include "UnityCG.cginc"
    #include "Lighting.cginc"
    #include "AutoLight.cginc"
    #include "CloudbakeLook.hlsl"

    struct Attributes {
      float4 vertex : POSITION;
      float3 normal : NORMAL;
#ifdef CLOUDBAKE_SEQUENCE
      float2 texel : TEXCOORD2;
#else
      float2 first : TEXCOORD@first_set@;
      float2 second : TEXCOORD@second_set@;
#endif
      UNITY_VERTEX_INPUT_INSTANCE_ID
    };
    struct Varyings {
      float4 pos : SV_POSITION;
      float2 light : TEXCOORD0;  // the shares of sun and sky
      float3 world : TEXCOORD1;
      float3 own : TEXCOORD2;    // in the object's space
      float3 normal : TEXCOORD3;
      float3 lamp : TEXCOORD4;   // of ForwardAdd, before it fades with its distance
      UNITY_FOG_COORDS(5)
      UNITY_LIGHTING_COORDS(6, 7)
      UNITY_VERTEX_INPUT_INSTANCE_ID
    };

    // Of _WorldSpaceLightPos0.
    float3 towardsLight(float3 place) {
      return _WorldSpaceLightPos0.w > 0.0 ? normalize(_WorldSpaceLightPos0.xyz - place) : _WorldSpaceLightPos0.xyz;
    }

    Varyings vertexOf(Attributes v) {
      UNITY_SETUP_INSTANCE_ID(v);
      Varyings output = (Varyings)0;
      UNITY_TRANSFER_INSTANCE_ID(v, output);
#ifdef CLOUDBAKE_SEQUENCE
      float4 lobe = worldVertex(v.texel, v.vertex.xyz, v.normal);
#else
      float4 lobe = worldLobe(v.first, v.second);
#endif
      output.world = mul(unity_ObjectToWorld, float4(v.vertex.xyz, 1.0)).xyz;
      output.normal = UnityObjectToWorldNormal(v.normal);
      output.light = sunAndSky(lobe, output.normal, towardsLight(output.world));
      float3 lamp_place = output.world + towardsLight(output.world) * 1e3;
      if (_WorldSpaceLightPos0.w > 0.0) lamp_place = _WorldSpaceLightPos0.xyz;
      output.lamp = lampShare(lamp_place, _LightColor0.rgb, lobe, output.world, output.normal);
      output.own = v.vertex.xyz;
      output.pos = UnityObjectToClipPos(v.vertex);
      UNITY_TRANSFER_FOG(output, output.pos);
      UNITY_TRANSFER_LIGHTING(output, float2(0.0, 0.0));
      return output;
    }

    float opacityOf(Varyings input) {
      float3 from_eye = input.world - _WorldSpaceCameraPos;
      float along = -mul(UNITY_MATRIX_V, float4(input.world, 1.0)).z;
      float opacity = opacityAt(input.pos, input.own, input.normal, from_eye, along, _ZBufferParams);
      leaveOut(input.pos, opacity, unity_LODFade.x);
      return _AlphaToMask > 0.5 ? opacity : 1.0;
    }
    ENDCG

    Pass {
      Tags { "LightMode" = "ForwardBase" }
      ZWrite On
      AlphaToMask [_AlphaToMask]
      CGPROGRAM
      #pragma vertex vertexOf
      #pragma fragment fragment
      #pragma multi_compile_instancing
      #pragma multi_compile_fog
      #pragma multi_compile _ LOD_FADE_CROSSFADE
      #pragma shader_feature_local CLOUDBAKE_SEQUENCE

      half4 fragment(Varyings input) : SV_Target {
        UNITY_SETUP_INSTANCE_ID(input);
        float opacity = opacityOf(input);
        float3 view = normalize(input.world - _WorldSpaceCameraPos);
        float factor = _SunStrength * phaseFactor(view, _WorldSpaceLightPos0.xyz, _PhaseShare, _PhaseAsymmetry, _PhaseLimit);
        float3 color = cloudColor(input.light.x, input.light.y, factor * _LightColor0.rgb, _AmbientSky.rgb, _AmbientGround.rgb);
        UNITY_APPLY_FOG(input.fogCoord, color);
        return half4(color, opacity);
      }
      ENDCG
    }
    Pass {
      Tags { "LightMode" = "ForwardAdd" }
      Blend One One
      ZWrite Off
      CGPROGRAM
      #pragma vertex vertexOf
      #pragma fragment fragment
      #pragma multi_compile_instancing
      #pragma multi_compile_fog
      #pragma multi_compile_fwdadd
      #pragma multi_compile _ LOD_FADE_CROSSFADE
      #pragma shader_feature_local CLOUDBAKE_SEQUENCE

      half4 fragment(Varyings input) : SV_Target {
        UNITY_SETUP_INSTANCE_ID(input);
        float opacity = opacityOf(input);
        UNITY_LIGHT_ATTENUATION(attenuation, input, input.world);
        float3 color = input.lamp * attenuation;
        UNITY_APPLY_FOG_COLOR(input.fogCoord, color, fixed4(0.0, 0.0, 0.0, 0.0));
        return half4(color, opacity);
      }
      ENDCG
    }
  }
}
