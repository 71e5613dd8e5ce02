// cloudbake @version@: the body of a Custom node in Unreal: a flow stirs the picture. Inputs: Channels, a texture object; UV, TexCoord 0;
// Seconds, the Time node. Output: CMOT Float 4.
#structure Cloudbake noise channel_sum distort.frag
Cloudbake cloudbake;
const float cycles = Seconds * @chain_swirl_speed@;
const float first = frac(cycles);
const float4 moved = cycles * float4(float2(@chain_near_drift@), float2(@chain_far_drift@) * @chain_far_tiles@);
cloudbake.gl_FragCoord = float4(UV * cloudbake.textureSize(Channels, 0), 0.0, 1.0);
cloudbake.channels = Channels;
cloudbake.tile_size = @chain_tile_size@;
cloudbake.far_tiles = @chain_far_tiles@;
cloudbake.swirl_strength = @chain_swirl_strength@;
cloudbake.far_strength = @chain_far_strength@;
cloudbake.phases = float3(first, frac(first + 0.5), abs(2.0 * first - 1.0));
cloudbake.drift = frac(moved * float4(1.0, -1.0, 1.0, -1.0));  // rows begin at the top here
cloudbake.seed = @chain_seed@;
cloudbake.octaves = @swirl_octaves@;
cloudbake.cells = @swirl_cells@;
cloudbake.gain = @swirl_gain@;
cloudbake.typical_slope = @swirl_slope@;
cloudbake.dark = @chain_dark@;
cloudbake.mean_all = false;
cloudbake.write();
return cloudbake.value;
