// cloudbake sequence FRAMES -o cloud.glb: a cloud that changes, from the frames of a simulation, an animation or a growing cloud.
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/allocation.h"
#include "app/commands.h"
#include "app/progress.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/write.h"
#include "io/gltf/sequence/sequence_file.h"
#include "pipeline/options/resolve.h"
#include "pipeline/sequence/sequence.h"
#include "pipeline/sources/grown.h"

namespace cloudbake {

namespace {

struct WrittenFile {
  std::filesystem::path file;
  std::string bytes;
};

// A baked asset for each key: STEM_SEGMENT_FRAME.glb.
std::vector<WrittenFile> keyFiles(const CloudSequence& sequence, const Settings& settings, Warnings& warnings) {
  std::vector<WrittenFile> files;
  const std::filesystem::path stem = std::filesystem::path(settings.output.file).replace_extension();
  for (size_t s = 0; s < sequence.segments.size(); ++s)
    for (const SequenceKey& key : sequence.segments[s].keys) {
      const Sculpt sculpt = sculptOf("cloud", {key.positions, key.normals, sequence.segments[s].triangles});
      const std::vector<std::vector<Lobe>> lobes{key.lobes};
      files.push_back({fmt::format("{}_{:02}_{:04}.glb", stem.string(), s + 1, key.frame),
                       encodeGlb(sculpt, lobes, sequence.info, settings.output.gltf, warnings)});
    }
  return files;
}

// The frames of a pattern or a folder are only known once it has been searched.
void refuseToReplaceFrames(const std::vector<FrameInput>& frames, const CommandLine& line) {
  RunFiles files;
  for (const FrameInput& frame : frames) files.inputs.push_back({frame.file, "a frame"});
  files.outputs.push_back(outputOf(line));
  addNamedFiles(files);
  refuseSharedFiles(files);
}

}  // namespace

ExitCode runSequence(const CommandLine& line) {
  keepLargeBlocks();
  BakeReport report;
  report.command = "sequence";
  report.input = line.input.string();
  Stopwatch watch = watchOnTerminal(line.quiet);
  CommandLine first = line;
  std::vector<Given> given = line.given;
  std::vector<FrameInput> frames;
  std::optional<GrownSource> source;
  if (isGrown(sourceKindOf(line.input))) {
    source = readGrownSource(sourceOf(line));
    given = withRecipe(*source, line.given);
  } else if (!mayBeAnimated(line.input)) {
    frames = frameFiles(line.input);
    refuseToReplaceFrames(frames, line);
    first.input = frames.front().file;
  }
  Settings settings = settingsOf(first, given);
  if (!frames.empty() && (settings.sequence.frames || !settings.sequence.animation.empty()))
    throw UsageError("--frame-count and --animation do not apply to frames that are files: leave them out");
  if (frames.empty()) frames = madeFrames(settings, source);
  const BakedSequence baked = bakeSequence(frames, settings, given, report, watch);
  std::vector<WrittenFile> files;
  switch (settings.sequence.output) {
    case SequenceOutput::kKeys: files = keyFiles(baked.sequence, settings, report.warnings); break;
    case SequenceOutput::kMorph: files = {{settings.output.file, encodeSequence(baked.sequence, SequenceForm::kMorph)}}; break;
    case SequenceOutput::kPicture: files = {{settings.output.file, encodeSequence(baked.sequence, SequenceForm::kTexture)}}; break;
  }
  watch.lap(report.seconds, "encode");
  enforceStrict(settings.run.strict, report);
  std::vector<FileBytes> together;
  for (const WrittenFile& file : files) together.push_back({file.file, file.bytes});
  writeFilesTogether(together);
  report.output = files.front().file.string();
  watch.lap(report.seconds, "write");
  Json json = sequenceJson(baked);
  size_t bytes = 0;
  for (const WrittenFile& file : files) {
    bytes += file.bytes.size();
    json["files"].push_back(file.file.string());
  }
  json["bytes"] = bytes;
  tellReport(settings.run, report, {{"sequence", json}}, sequenceText(baked) + fmt::format("bytes       {}\n", bytes));
  return ExitCode::kDone;
}

}  // namespace cloudbake
