// cloudbake @version@: the body of a Custom node in Unreal. Inputs: First and Second, the TextureCoordinates @first_set@ and @second_set@.
// Output: CMOT Float 3, the vector o * d in the mesh's space, in centimetres. docs/engines/unreal.md has the steps.
// Unreal swaps y and z of what it imports, and scales metres to centimetres, but not UVs.
return float3(First.x, Second.x, First.y) * (Second.y * 100.0);
