// Bakes an octahedron and prints, per vertex, how much of the light from above arrives there.
#include <cloudbake.h>

#include <cstdio>
#include <fstream>

int main(int, char** argv) try {
  cloudbake::SurfaceMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const cloudbake::BakeResult baked = cloudbake::bake(mesh, {{"rays", "200"}});
  for (const cloudbake::Lobe& lobe : baked.lobes)
    std::printf("%.3f %.3f %.3f  %.3f  T %.3f\n", lobe.direction.x, lobe.direction.y, lobe.direction.z, lobe.thickness,
                cloudbake::lobeTransmittance(lobe, {0, 1, 0}, baked.info.shape, baked.info.extinction));
  std::ofstream(argv[1], std::ios::binary) << baked.glb;
} catch (const cloudbake::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return int(error.code);
}
