// cloudbake @version@: the body of a Custom node in Unreal: noise wears rims away. Inputs: Channels, a texture object; UV, TexCoord 0;
// DepthRange, float 2, as for Channels.hlsl; Eye, Right, Up and Forward of the camera; HeightAtOne, 2 * tan(vertical field of view / 2);
// Origin, the place of a cloud; Size, the mean longest side of the clouds, all in centimetres. Output: CMOT Float 4.
#structure Cloudbake noise view erode.frag
Cloudbake cloudbake;
cloudbake.picture = cloudbake.textureSize(Channels, 0);
cloudbake.gl_FragCoord = float4(UV * cloudbake.picture, 0.0, 1.0);
cloudbake.channels = Channels;
cloudbake.eye = Eye;
cloudbake.right = Right;
cloudbake.up = -Up;  // rows begin at the top
cloudbake.forward = Forward;
cloudbake.per_pixel = HeightAtOne / cloudbake.picture.y;
cloudbake.depth_range = DepthRange;
cloudbake.noise_origin = Origin;
cloudbake.noise_size = @chain_detail_size@ * Size;
cloudbake.shrink = @chain_detail_shrink@;
cloudbake.darkening = @chain_detail_darkening@;
cloudbake.fading = float2(@erosion_fading@);
cloudbake.seed = @chain_seed@;
cloudbake.octaves = @erosion_octaves@;
cloudbake.gain = @erosion_gain@;
cloudbake.write();
return cloudbake.value;
