// posed_sculpt SCULPT FOLDER SECONDS...
// The first animation of a sculpt: FOLDER/0.obj and so on, in metres, +Y up, at each of these moments since its first key. Prints its
// length in seconds.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "core/error.h"
#include "io/file/write_file.h"
#include "io/sculpt/read_mesh.h"

using namespace cloudbake;

int main(int argc, char** argv) {
  if (argc < 4) return 1;
  const std::filesystem::path file = argv[1], folder = argv[2];
  double seconds = 0;
  for (int i = 3; i < argc; ++i) try {
      ReadSettings settings;
      settings.moment = {"", std::atof(argv[i])};
      Warnings warnings;
      const Sculpt sculpt = readMesh(file, settings, warnings);
      seconds = sculpt.animation_seconds;
      for (const auto& [kind, entry] : warnings.entries()) fmt::print(stderr, "{}: {}\n", warningName(kind), entry.first);
      const SurfaceMesh mesh = surfaceInScene(sculpt);
      std::string text;
      for (const Vec3& p : mesh.positions) text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
      for (const Triangle& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
      writeFileAtomically(folder / fmt::format("{}.obj", i - 3), text);
    } catch (const Error& error) {
      fmt::print(stderr, "posed_sculpt: {}\n", error.what());
      return int(error.code);
    }
  fmt::print("{:.9g}\n", seconds);
  return 0;
}
