// cloudbake @version@: the body of a Custom node in Unreal: a mean along rows or columns, whose width follows the depth. Inputs: Image and
// Channels, texture objects; UV, TexCoord 0; Axis, float 2: (1, 0) or (0, 1); Widths, float 2: half widths at depth 0 and 1, in heights of
// the picture (@chain_near_width@ and @chain_far_width@ before Soft, @chain_depth_spread@ twice before Spread). Output: CMOT Float 4.
#structure Cloudbake box.frag
Cloudbake cloudbake;
const int2 size = cloudbake.textureSize(Channels, 0);
cloudbake.gl_FragCoord = float4(UV * size, 0.0, 1.0);
cloudbake.image = Image;
cloudbake.channels = Channels;
cloudbake.axis = int2(Axis);
cloudbake.near_half = Widths.x * size.y;
cloudbake.far_half = Widths.y * size.y;
cloudbake.write();
return cloudbake.value;
