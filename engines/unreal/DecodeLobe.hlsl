// cloudbake @version@: the body of a Custom node in Unreal. Inputs: First and Second, the TextureCoordinates @first_set@ and @second_set@.
// Output: CMOT Float 3, the vector o * d in the mesh's space, in centimetres. docs/engines/unreal.md has the steps.
// Unreal swaps y and z of what it imports, and scales metres to centimetres, but not UVs.
const float density_max = @density_max@;  // of a packed asset, else 0
if (density_max > 0.0)
{
  const float height = 1.0 - abs(First.x) - abs(First.y), fold = max(-height, 0.0);
  const float3 o = normalize(float3(First.x - (First.x < 0.0 ? -fold : fold), height, First.y - (First.y < 0.0 ? -fold : fold)));
  return o * (density_max * Second.y * Second.y * 100.0);
}
return float3(First.x, Second.x, First.y) * (Second.y * 100.0);
