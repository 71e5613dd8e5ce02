// apngasm 2 reads frames from numbered files and writes a file. A temporary folder holds them.
#include "io/image/animated_png.h"

#include <fmt/format.h>

#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/error.h"
#include "io/file/process.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr const char* kEncoder = "apngasm";

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "cloudbake-XXXXXX").string();
    if (!::mkdtemp(name.data()))
      throw IoError(name, "cannot create a temporary folder for frames: free some disk space, or set TMPDIR to a folder on another disk");
    path = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  fs::path path;
};

std::string frameName(size_t index) { return fmt::format("frame{:06}.png", index); }

// Runs apngasm without output. Returns false if it fails or is not there.
bool runEncoder(const fs::path& out, const fs::path& first, const std::string& numerator, const std::string& denominator) {
  const auto program = findProgram(kEncoder);
  if (!program) return false;
  const Inherited silent[] = {{STDOUT_FILENO}};
  const int status =
      waitForProcess(startProcess(*program, {kEncoder, out.string(), first.string(), numerator, denominator, "-z1"}, silent));
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

bool hasAnimationEncoder() { return findProgram(kEncoder).has_value(); }

std::string encodeAnimation(std::span<const std::string> frames, double frames_per_second) {
  const TemporaryFolder folder;
  for (size_t i = 0; i < frames.size(); ++i) writeFileAtomically(folder.path / frameName(i), frames[i]);
  const fs::path out = folder.path / "animation.png";
  if (!runEncoder(out, folder.path / frameName(0), "100", std::to_string(std::lround(100 * frames_per_second))) || !fs::exists(out))
    throw IoError(out.string(), "apngasm failed to join the frames: check that it is installed and that the disk has space");
  return readFileBytes(out);
}

}  // namespace cloudbake
