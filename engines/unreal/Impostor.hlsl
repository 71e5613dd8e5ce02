// cloudbake @version@: the body of a Custom node in Unreal: an impostor (`cloudbake impostor`) on a cube that covers its ball, in an
// Unlit, Translucent material. Inputs: Place, LocalPosition in radii (of the engine's cube: divided by 50); Eye, the camera's position by
// a TransformPosition node from world to local space, in radii too; ToSun and Up, the unit vectors to the sun and upwards by
// TransformVector nodes from world to local space; Texels: the distance of the camera from the object, times the tangent of half of the
// vertical field of view, over the height of the picture in pixels, over the radius in the world, times the pixels of a view; Atlas,
// float 4: views, pixels of a view, last mip level (4 pixels to a side of a view), and thickest over the radius; Lobe, float 2: the
// exponent, and the extinction times the radius, of the JSON; LobePicture and RestPicture, texture objects: the two pictures, sRGB off,
// addressing Clamp. Output: CMOT Float 3: the shares of the light of sun and sky, and the opacity. The object may be turned, moved and
// scaled by one factor.
struct Cloudbake {
#define textureLod(image, at, level) image.SampleLevel(image##Sampler, at, level)
Texture2D<float4> impostor_lobe, impostor_rest;
SamplerState impostor_lobeSampler, impostor_restSampler;
float4 impostor_atlas;
#include "lobe.hlsl"

#include "impostor.hlsl"

#include "impostor_atlas.hlsl"
};
Cloudbake cloudbake;
cloudbake.impostor_lobe = LobePicture;
cloudbake.impostor_rest = RestPicture;
cloudbake.impostor_lobeSampler = LobePictureSampler;
cloudbake.impostor_restSampler = RestPictureSampler;
cloudbake.impostor_atlas = Atlas;
// Unreal's importer swaps y and z.
float3 rest;
const float4 lobe = cloudbake.impostorSeen(Eye.xzy, (Place - Eye).xzy, normalize(Eye.xzy), Texels, rest);
return float3(rest.x * cloudbake.lobeTransmittance(lobe, normalize(ToSun.xzy), float2(Lobe.x, 0.0), Lobe.y),
              rest.x * cloudbake.lobeTransmittance(lobe, normalize(Up.xzy), float2(Lobe.x, 0.0), Lobe.y), rest.z);
