// cloudbake @version@: the body of a Custom node in Unreal, of a post-process material: the clouds over the scene, behind what is nearer.
// Inputs: Channels, the image of the last step, and Drawn, that of Resolve, texture objects; UV, ViewportUV; Picture, float 2, the ViewSize
// node; Scene, SceneTexture PostProcessInput0; Solid, SceneTexture SceneDepth; DepthRange, float 2, as for Channels.hlsl; View, the unit
// vector from the eye (CameraVectorWS times -1); Forward, CameraDirectionVector; ToSun; SunColor, AmbientSky, AmbientGround, FogColor,
// linear colors; SoftDistance, and FarFade, float 2, in centimetres (0: none). Output: CMOT Float 3, for Emissive Color.
#structure Cloudbake light noise soft view channel_sum light_uniforms composite solid
Cloudbake cloudbake;
cloudbake.picture = Picture;
// The view of the pixel is known.
cloudbake.forward = View;
cloudbake.right = float3(0.0, 0.0, 0.0);
cloudbake.up = float3(0.0, 0.0, 0.0);
cloudbake.per_pixel = 0.0;
cloudbake.mean_all = false;
cloudbake.channels = Channels;
cloudbake.drawn = Drawn;
cloudbake.depth_range = DepthRange;
cloudbake.to_sun = ToSun;
cloudbake.sun_color = SunColor;
cloudbake.ambient_sky = AmbientSky;
cloudbake.ambient_ground = AmbientGround;
cloudbake.fog_color = FogColor;
cloudbake.fog_density = @fog_density@;
cloudbake.distance_fog = @fog_per_unit@ / 100.0 / dot(View, Forward);
cloudbake.fog_scatter = float2(@fog_scatter@, @fog_scatter_exponent@);
cloudbake.phase = float3(@light_phase@, @light_phase_asymmetry@, @light_phase_limit@);
cloudbake.soft_distance = SoftDistance;
cloudbake.far_fade = FarFade;
const int2 at = int2(UV * Picture);
return cloudbake.behindClouds(Scene, cloudbake.visibleChannels(at, Solid), at);
