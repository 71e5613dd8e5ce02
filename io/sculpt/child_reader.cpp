// The answer is a byte 'S' and the sculpt with its warnings and the hashes of other files that were read, or 'E' and the error, each after
// the version. docs/architecture.md, Difficult parts, says what this relies on.
#include "io/sculpt/child_reader.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "core/memory_budget.h"
#include "core/text/numbers.h"
#include "core/text/scan.h"
#include "io/file/input_files.h"
#include "io/file/process.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr int kAnswerDescriptor = 3, kInputDescriptor = 4;
// Numbers are copied from memory, so both ends must be the same program.
constexpr std::string_view kSculptAnswer = "S" CLOUDBAKE_VERSION, kErrorAnswer = "E" CLOUDBAKE_VERSION;
constexpr const char* kReadingCure = "export a smaller file, or as glTF";

// Files that the child has read beside the sculpt, and the hashes of their bytes; empty: it cannot be read.
using FilesRead = std::vector<std::pair<std::string, std::string>>;

// --- Bytes ---

struct ByteWriter {
  std::string bytes;

  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class Container>
  void addAll(const Container& values) {
    using T = typename Container::value_type;
    static_assert(std::is_trivially_copyable_v<T>);
    add(uint64_t(values.size()));
    if (!values.empty()) bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
};

// Throws std::out_of_range if the bytes end too early, or are no value of a type.
struct ByteReader {
  std::string_view rest;

  std::string_view take(uint64_t count) {
    if (count > rest.size()) throw std::out_of_range("the answer ends too early");
    const std::string_view taken = rest.substr(0, count);
    rest.remove_prefix(count);
    return taken;
  }
  template <class T>
  T get() {
    T value;
    if constexpr (std::is_same_v<T, bool>) {
      const auto byte = get<uint8_t>();
      if (byte > 1) throw std::out_of_range("the answer has a truth that is neither");
      value = byte == 1;
    } else {
      std::memcpy(&value, take(sizeof value).data(), sizeof value);
    }
    return value;
  }
  template <class Container>
  Container getAll() {
    using T = typename Container::value_type;
    const uint64_t count = get<uint64_t>();
    if (count > rest.size() / sizeof(T)) throw std::out_of_range("the answer ends too early");
    Container values(count, T{});
    if (count > 0) std::memcpy(values.data(), take(count * sizeof(T)).data(), count * sizeof(T));
    return values;
  }
};

// Writer and reader of a sculpt go through the same members in the same order. The compiler refuses a struct with more of them.
template <class T, class Struct>
concept Is = std::is_same_v<std::remove_const_t<T>, Struct>;
auto membersOf(Is<SculptPart> auto& part) {
  auto& [name, positions, normals, uvs, triangles, to_scene, object, repaired, node, material, colors, more_uvs, vertex_to_scene, fixed,
         midpoints] = part;
  return std::tie(name, positions, normals, uvs, triangles, to_scene, object, repaired, node, material, colors, more_uvs, vertex_to_scene,
                  fixed, midpoints);
}
auto membersOf(Is<SculptNode> auto& one) {
  auto& [name, parent, local] = one;
  return std::tie(name, parent, local);
}
auto membersOf(Is<SculptMaterial> auto& material) {
  auto& [name, base_color, emission, metallic, roughness, double_sided, blended, normal_scale, base_color_texture,
         metallic_roughness_texture, normal_texture, occlusion_texture, emissive_texture] = material;
  return std::tie(name, base_color, emission, metallic, roughness, double_sided, blended, normal_scale, base_color_texture,
                  metallic_roughness_texture, normal_texture, occlusion_texture, emissive_texture);
}
auto membersOf(Is<SculptImage> auto& image) {
  auto& [name, bytes, mime_type] = image;
  return std::tie(name, bytes, mime_type);
}
auto membersOf(Is<Sculpt> auto& sculpt) {
  auto& [parts, gltf, frame_note, nodes, materials, images, animation_seconds] = sculpt;  // no foreign format is glTF
  return std::tie(parts, frame_note, nodes, materials, images, animation_seconds);
}

struct SculptWriter {
  ByteWriter& writer;
  void operator()(const std::string& text) const { writer.addAll(text); }
  template <class T>
  void operator()(const std::vector<T>& values) const {
    if constexpr (std::is_trivially_copyable_v<T>) return writer.addAll(values);
    writer.add(uint64_t(values.size()));
    for (const T& value : values) (*this)(value);
  }
  template <class T>
  void operator()(const T& value) const {
    if constexpr (requires { membersOf(value); })
      std::apply([&](const auto&... members) { ((*this)(members), ...); }, membersOf(value));
    else
      writer.add(value);
  }
};

struct SculptReader {
  ByteReader& reader;
  void operator()(std::string& text) const { text = reader.getAll<std::string>(); }
  template <class T>
  void operator()(std::vector<T>& values) const {
    if constexpr (std::is_trivially_copyable_v<T>) {
      values = reader.getAll<std::vector<T>>();
    } else {
      for (uint64_t left = reader.get<uint64_t>(); left > 0; --left) (*this)(values.emplace_back());
    }
  }
  template <class T>
  void operator()(T& value) const {
    if constexpr (requires { membersOf(value); })
      std::apply([&](auto&... members) { ((*this)(members), ...); }, membersOf(value));
    else
      value = reader.get<T>();
  }
};

std::string encodeSculpt(const Sculpt& sculpt, const Warnings& warnings, const FilesRead& files) {
  ByteWriter writer{std::string(kSculptAnswer)};
  SculptWriter{writer}(sculpt);
  writer.add(uint64_t(warnings.entries().size()));
  for (const auto& [kind, entry] : warnings.entries()) {
    writer.add(kind);
    writer.add(entry.count);
    writer.addAll(entry.first);
  }
  writer.add(uint64_t(files.size()));
  for (const auto& [file, hash] : files) writer.addAll(file), writer.addAll(hash);
  return std::move(writer.bytes);
}

std::string encodeError(const Error& error) {
  ByteWriter writer{std::string(kErrorAnswer)};
  writer.add(error.code);
  writer.addAll(error.file);
  writer.add(error.line);
  writer.add(error.column);
  writer.addAll(error.message);
  writer.add(dynamic_cast<const MemoryError*>(&error) != nullptr);
  return std::move(writer.bytes);
}

// The hash of what this process reads under this name; empty if it cannot.
std::string hashOfFile(const std::string& file, const FileReader& read_file) {
  try {
    return hashBytes(read_file(file));
  } catch (const IoError&) {
    return "";
  }
}

Sculpt decodeSculpt(ByteReader& reader, const ReadSettings& settings, Warnings& warnings) {
  Sculpt sculpt;
  SculptReader{reader}(sculpt);
  for (uint64_t entries = reader.get<uint64_t>(); entries > 0; --entries) {
    const auto kind = reader.get<WarningKind>();
    const auto count = reader.get<uint64_t>();
    warnings.add(kind, reader.getAll<std::string>(), count);
  }
  for (uint64_t files = reader.get<uint64_t>(); files > 0; --files) {
    const auto file = reader.getAll<std::string>();
    if (reader.getAll<std::string>() != hashOfFile(file, settings.read_file)) throw changedWhileRead(file);
  }
  if (!reader.rest.empty()) throw std::out_of_range("the answer goes on after its end");
  return sculpt;
}

[[noreturn]] void throwError(ByteReader& reader) {
  const auto code = reader.get<ExitCode>();
  const auto file = reader.getAll<std::string>();
  const auto line = reader.get<int>(), column = reader.get<int>();
  const auto message = reader.getAll<std::string>();
  if (reader.get<bool>()) throw MemoryError(file, message);
  throw Error(code, file, line, column, message);
}

// --- The parent ---

using Clock = std::chrono::steady_clock;

pid_t startChild(const fs::path& file, const std::string& bytes, const std::string& extension, const ReadSettings& settings,
                 const ChildLimits& limits, Descriptor& answer) {
  Descriptor to_write, input;
  openPipe(answer, to_write);
  openInMemory(input, bytes);
  const Inherited inherited[] = {
      {STDIN_FILENO}, {STDOUT_FILENO}, {STDERR_FILENO}, {kAnswerDescriptor, to_write.number}, {kInputDescriptor, input.number}};
  return startProcess(settings.child_program,
                      {settings.child_program.string(), kChildReaderCommand, file.string(), extension,
                       settings.metres_per_unit ? shortestText(*settings.metres_per_unit) : "",
                       settings.up_axis ? std::to_string(int(*settings.up_axis)) : "",
                       settings.moment ? shortestText(settings.moment->seconds) : "", settings.moment ? settings.moment->animation : "",
                       std::to_string(uint64_t(limits.seconds) + 1) + " " + std::to_string(limits.memory) +
                           (settings.allow_outside ? " 1" : " 0") + (settings.frame_if_unstated ? " 1" : " 0")},
                      inherited);
}

// A process that is not left alone: it has ended when this has.
class Child {
 public:
  explicit Child(pid_t process) : process_(process) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (process_ > 0) kill(), wait();
  }
  void kill() const { killProcess(process_); }
  ProcessEnd wait() { return waitForProcess(std::exchange(process_, 0)); }

 private:
  pid_t process_;
};

// What the child wrote until it closed its end, or why it has to be stopped.
struct Answer {
  std::string bytes, trouble;
};

Answer collectAnswer(int descriptor, const ChildLimits& limits) {
  const auto deadline = Clock::now() + std::chrono::duration<double>(limits.seconds);
  Answer answer;
  std::array<char, 1 << 16> block{};
  while (answer.trouble.empty() && answer.bytes.size() <= limits.largest) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) {
      answer.trouble = "its reader process was stopped after " + shortestText(limits.seconds) + " seconds";
      break;
    }
    if (!waitForBytes(descriptor, std::chrono::milliseconds(left))) continue;
    const long count = readSome(descriptor, std::as_writable_bytes(std::span(block)));
    if (count == 0) break;
    if (count < 0) answer.trouble = std::string("its reader process cannot be listened to: ") + std::strerror(errno);
    if (count > 0) answer.bytes.append(block.data(), size_t(count));
  }
  return answer;
}

// How a child ended that was not stopped and gave no whole answer.
std::string whatHappened(const ProcessEnd& end) {
  if (isFault(end.signal))
    return "its reader process crashed (" + signalText(end.signal) + "); the file may be damaged: export it again, or";
  if (end.signal != 0)
    return "its reader process was killed (" + signalText(end.signal) +
           "); close other programs if the system had no memory left, and try again, or export it";
  return "its reader process ended with exit code " + std::to_string(end.code) + " and without a result that is whole; export it again, or";
}

}  // namespace

Sculpt readInChild(const fs::path& file, const std::string& bytes, const std::string& extension, const ReadSettings& settings,
                   Warnings& warnings, const ChildLimits& limits) {
  Descriptor pipe;
  Child child(startChild(file, bytes, extension, settings, limits, pipe));
  const Answer answer = collectAnswer(pipe.number, limits);
  pipe.close();
  if (!answer.trouble.empty() || answer.bytes.size() > limits.largest) child.kill();
  const ProcessEnd end = child.wait();
  requireMemory({"the parts of this sculpt, which its reader process has passed on so far,", double(answer.bytes.size()), kReadingCure},
                limits.largest, file.string());
  if (!answer.trouble.empty()) throw InputError(file.string(), answer.trouble + "; export a smaller sculpt, or export it as glTF or OBJ");
  if (end.signal == 0 && end.code == 0) try {
      ByteReader reader{answer.bytes};
      const std::string_view kind = reader.take(kSculptAnswer.size());
      if (kind == kErrorAnswer) throwError(reader);
      if (kind == kSculptAnswer) return decodeSculpt(reader, settings, warnings);
    } catch (const std::out_of_range&) {
      // Reported below
    }
  throw InputError(file.string(), whatHappened(end) + " as glTF or OBJ");
}

int serveChildReader(int argc, char** argv) {
  if (argc != 8) return 1;
  endWithParent();
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C reaches this process too, but the parent decides whether to stop
  std::string_view limits = argv[7];
  const auto seconds = parseInteger(takeWord(limits)), memory = parseInteger(takeWord(limits)), outside = parseInteger(takeWord(limits)),
             if_unstated = parseInteger(takeWord(limits));
  if (!seconds || !memory || !outside || !if_unstated) return 1;
  limitThisProcess(uint64_t(*seconds), uint64_t(*memory));

  std::string answer;
  try {
    const fs::path file = argv[1];
    ReadSettings settings;
    settings.allow_outside = *outside != 0;
    settings.frame_if_unstated = *if_unstated != 0;
    settings.metres_per_unit = parseNumber(argv[3]);
    if (const auto axis = parseInteger(argv[4])) settings.up_axis = UpAxis(*axis);
    if (const auto moment = parseNumber(argv[5])) settings.moment = {argv[6], *moment};
    FilesRead files;
    settings.read_file = [&](const fs::path& other) {
      std::string& hash = files.emplace_back(other.string(), "").second;
      std::string bytes = readFileBytes(other);
      hash = hashBytes(bytes);
      return bytes;
    };
    std::string bytes;
    if (readToEnd(kInputDescriptor, bytes) != 0) return 1;
    Warnings warnings;
    answer = namingFile(file.string(), [&] {
      return inStage("the process that reads this file", kReadingCure,
                     [&] { return encodeSculpt(readWithAssimp(file, bytes, argv[2], settings, warnings), warnings, files); });
    });
  } catch (const Error& error) {
    answer = encodeError(error);
  } catch (const std::exception& error) {
    answer = encodeError(InputError(argv[1], std::string("its reader failed: ") + error.what() + "; export it again"));
  }
  return writeAll(kAnswerDescriptor, answer) == 0 ? 0 : 1;
}

}  // namespace cloudbake
