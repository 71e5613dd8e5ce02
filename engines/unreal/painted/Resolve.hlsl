// cloudbake @version@: the body of a Custom node in Unreal: from what was captured (sun, sky, depth, 1 - opacity), with 2 x 2 pixels for
// each of the chain, to channels. Inputs: Captured, a texture object; UV, TexCoord 0. Output: CMOT Float 4.
#structure Cloudbake channel_sum
Cloudbake cloudbake;
cloudbake.mean_all = false;
const int2 first = int2(UV * (cloudbake.textureSize(Captured, 0) / 2)) * 2;
ChannelSum sum = cloudbake.makeChannelSum(float4(0.0, 0.0, 0.0, 0.0), float2(0.0, 0.0));
for (int i = 0; i < 4; ++i) {
  const float4 captured = Captured.Load(int3(first + int2(i % 2, i / 2), 0));
  cloudbake.addChannels(float4(captured.rg, saturate(1.0 - captured.a), captured.b), 1.0, sum);
}
return cloudbake.channelMean(sum);
