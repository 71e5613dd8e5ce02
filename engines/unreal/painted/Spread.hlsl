// cloudbake @version@: the body of a Custom node in Unreal: depth carried beyond the clouds. Inputs: Channels, and Weighted, which
// the boxes made of it, texture objects; UV, TexCoord 0. Output: CMOT Float 4.
#structure Cloudbake spread.frag
Cloudbake cloudbake;
cloudbake.gl_FragCoord = float4(UV * cloudbake.textureSize(Channels, 0), 0.0, 1.0);
cloudbake.channels = Channels;
cloudbake.weighted = Weighted;
cloudbake.write();
return cloudbake.value;
