// cloudbake @version@: the body of a Custom node in Unreal: what boxes average. Inputs: Channels, a texture object; UV, TexCoord 0;
// OfDepth: 1 before Spread, 0 before Soft. Output: CMOT Float 4.
#structure Cloudbake weighted.frag
Cloudbake cloudbake;
cloudbake.gl_FragCoord = float4(UV * cloudbake.textureSize(Channels, 0), 0.0, 1.0);
cloudbake.channels = Channels;
cloudbake.of_depth = OfDepth > 0.5;
cloudbake.write();
return cloudbake.value;
