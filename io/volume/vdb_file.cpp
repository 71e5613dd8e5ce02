// Reads bytes in memory in the way of openvdb::io::File (header, metadata, one descriptor per grid). Here a read past the end throws at
// once, the length of a text is checked before it is read, and only the chosen grid is loaded if the file has offsets of its grids.
#include "io/volume/vdb_file.h"

#include <fmt/format.h>

#include <openvdb/io/Archive.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>

#include <algorithm>
#include <istream>
#include <mutex>
#include <stdexcept>
#include <streambuf>

#include "core/error.h"
#include "core/memory_budget.h"

namespace cloudbake {

namespace {

namespace vdb = openvdb;

// A stream in which a read succeeds completely or throws.
class BytesBuffer : public std::streambuf {
 public:
  explicit BytesBuffer(std::string& bytes) { setg(bytes.data(), bytes.data(), bytes.data() + bytes.size()); }

 protected:
  std::streamsize xsgetn(char* to, std::streamsize count) override {
    if (count < 0 || count > egptr() - gptr()) return 0;
    std::copy(gptr(), gptr() + count, to);
    setg(eback(), gptr() + count, egptr());
    return count;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type base = from == std::ios_base::beg ? 0 : from == std::ios_base::cur ? gptr() - eback() : egptr() - eback();
    const off_type size = egptr() - eback();
    if (offset < -base || offset > size - base) return pos_type(off_type(-1));
    setg(eback(), eback() + base + offset, egptr());
    return base + offset;
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override { return seekoff(position, std::ios_base::beg, mode); }
};

uint32_t readCount(std::istream& in) {
  uint32_t count = 0;
  in.read(reinterpret_cast<char*>(&count), sizeof count);
  return count;
}

// Reads a length and that many bytes. Throws if the file ends before.
void skipText(std::istream& in) { in.seekg(readCount(in), std::ios_base::cur); }

std::string readText(std::istream& in) {
  const auto begin = in.tellg();
  skipText(in);
  std::string text(size_t(in.tellg() - begin) - sizeof(uint32_t), '\0');
  in.seekg(begin + std::streamoff(sizeof(uint32_t)));
  in.read(text.data(), std::streamsize(text.size()));
  return text;
}

// A count, then name, type and value of each entry. OpenVDB reads a number by the size of its type and ignores the stored length.
void skipMetadata(std::istream& in) {
  for (uint32_t left = readCount(in); left > 0; --left) {
    skipText(in);
    const std::string type = readText(in);
    const uint32_t bytes = readCount(in);
    if (type != vdb::StringMetadata::staticTypeName() && vdb::Metadata::isRegisteredType(type) &&
        vdb::Metadata::createMetadata(type)->size() != bytes)
      throw std::runtime_error("metadata of type " + type + " with " + std::to_string(bytes) + " bytes");
    in.seekg(bytes, std::ios_base::cur);
  }
}

// Checks the tiles of a root node, because OpenVDB reads their flags unchecked into a bool. The data are the numbers of buffers, tiles and
// children, then place, value and flag of each tile.
void checkTiles(std::istream& in, std::streamoff value_bytes) {
  readCount(in);
  in.seekg(value_bytes, std::ios_base::cur);  // background
  const uint32_t tiles = readCount(in);
  readCount(in);
  for (uint32_t tile = 0; tile < tiles; ++tile) {
    in.seekg(3 * sizeof(int32_t) + value_bytes, std::ios_base::cur);
    if (in.get() > 1) throw std::runtime_error("a tile is neither active nor inactive");
  }
}

// Reads ahead with `walk`, then returns to the current position.
template <class Walk>
void lookAhead(std::istream& in, const Walk& walk) {
  const auto here = in.tellg();
  walk();
  in.seekg(here);
}

std::string contentOf(const std::string& type) {
  const auto has = [&](const char* piece) { return type.find(piece) != std::string::npos; };
  if (has("ptdata") || has("ptidx")) return "points";
  if (has("vec")) return "vectors";
  if (has("bool") || has("mask")) return "a mask";
  if (has("int")) return "whole numbers";
  return "values of type " + type;
}

bool isScalar(const vdb::io::GridDescriptor& d) {
  return d.gridType() == vdb::FloatGrid::gridType() || d.gridType() == vdb::DoubleGrid::gridType();
}

class BytesArchive : public vdb::io::Archive {
 public:
  struct Entry {
    vdb::io::GridDescriptor descriptor;
    vdb::GridBase::Ptr grid;  // with or without its values
    bool loaded = false;
  };
  std::vector<Entry> entries;

  explicit BytesArchive(std::string& bytes) : buffer_(bytes), in_(&buffer_) {
    in_.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    readHeader(in_);
    if (fileVersion() < vdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION)
      throw std::runtime_error("it was written by an OpenVDB before 2.0, which is not supported");
    vdb::io::setStreamMetadataPtr(in_, metadata_, false);
    setFormatVersion(in_);
    setLibraryVersion(in_);
    setDataCompression(in_);
    lookAhead(in_, [&] { skipMetadata(in_); });
    vdb::MetaMap().readMeta(in_);
    for (int32_t left = readGridCount(in_); left > 0; --left) readEntry();
  }

  // The grid with its values. If it shares the tree of another grid, it gets that tree.
  vdb::GridBase::Ptr load(Entry& entry) {
    loadHere(entry);
    if (entry.descriptor.isInstance())
      for (Entry& parent : entries)
        if (!parent.descriptor.isInstance() && parent.descriptor.uniqueName() == entry.descriptor.instanceParentName()) {
          if (parent.descriptor.gridType() != entry.descriptor.gridType()) throw vdb::TypeError("a shared tree of another type");
          loadHere(parent);
          entry.grid->setTree(parent.grid->baseTreePtr());
        }
    return entry.grid;
  }

 private:
  void readEntry() {
    Entry entry;
    lookAhead(in_, [&] {
      for (int text = 0; text < 3; ++text) skipText(in_);
    });
    entry.grid = entry.descriptor.read(in_);
    if (inputHasGridOffsets())
      entry.descriptor.seekToEnd(in_);
    else
      readValues(entry);
    entries.push_back(std::move(entry));
  }
  void loadHere(Entry& entry) {
    if (entry.loaded) return;
    entry.descriptor.seekToGrid(in_);
    readValues(entry);
  }
  void readValues(Entry& entry) {
    lookAhead(in_, [&] {
      readCount(in_);  // compression
      skipMetadata(in_);
      lookAhead(in_, [&] { skipText(in_); });  // type of the transform
      vdb::math::Transform().read(in_);
      if (isScalar(entry.descriptor) && !entry.descriptor.isInstance())
        checkTiles(in_, entry.descriptor.gridType() == vdb::FloatGrid::gridType() ? sizeof(float) : sizeof(double));
    });
    readGrid(entry.grid, entry.descriptor, in_);
    entry.loaded = true;
  }

  vdb::io::StreamMetadata::Ptr metadata_ = std::make_shared<vdb::io::StreamMetadata>();  // the stream points to it
  BytesBuffer buffer_;
  std::istream in_;
};

// OpenVDB's name of a grid that is like no other in the file, as its tools print it: "density[1]" for the second of that name.
std::string uniqueNameOf(const BytesArchive::Entry& entry) { return vdb::io::GridDescriptor::nameAsString(entry.descriptor.uniqueName()); }

std::string namesOf(const std::vector<BytesArchive::Entry>& entries) {
  std::string names;
  for (const auto& entry : entries) names += (names.empty() ? "'" : ", '") + uniqueNameOf(entry) + "'";
  return names.empty() ? "none" : names;
}

void warnIfChosen(const BytesArchive::Entry& chosen, const std::vector<BytesArchive::Entry>& entries, ptrdiff_t candidates,
                  Warnings& warnings) {
  if (candidates > 1)
    warnings.add(WarningKind::kGridChosen, "grid '" + uniqueNameOf(chosen) + "' was chosen from " + namesOf(entries) +
                                               ": --grid NAME chooses another, by a name as it is written here");
}

BytesArchive::Entry& chooseByName(std::vector<BytesArchive::Entry>& entries, const std::string& name, const std::string& file,
                                  Warnings& warnings) {
  const auto isUnique = [&](const auto& entry) { return uniqueNameOf(entry) == name; };
  const auto isNamed = [&](const auto& entry) { return entry.descriptor.gridName() == name; };
  auto found = std::find_if(entries.begin(), entries.end(), isUnique);
  if (found == entries.end()) {
    found = std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return isNamed(entry) && isScalar(entry.descriptor); });
    if (found == entries.end()) found = std::find_if(entries.begin(), entries.end(), isNamed);
    if (found == entries.end()) throw InputError(file, "no grid is named '" + name + "': there are " + namesOf(entries));
    warnIfChosen(*found, entries, std::count_if(entries.begin(), entries.end(), isNamed), warnings);
  }
  if (!isScalar(found->descriptor))
    throw InputError(file, "grid '" + name + "' holds " + contentOf(found->descriptor.gridType()) +
                               ", but a level set or fog volume of floats is needed: choose another grid with --grid");
  return *found;
}

BytesArchive::Entry& choose(std::vector<BytesArchive::Entry>& entries, const std::string& file, Warnings& warnings) {
  if (entries.empty()) throw InputError(file, "there is no grid in it: export the volume again");
  const auto likelihood = [](const auto& entry) {
    const std::string& name = entry.descriptor.gridName();
    return !isScalar(entry.descriptor) ? 0 : name == "surface" ? 3 : name == "density" ? 2 : 1;
  };
  BytesArchive::Entry* best = &entries.front();
  for (auto& entry : entries)
    if (likelihood(entry) > likelihood(*best)) best = &entry;
  if (likelihood(*best) == 0) return chooseByName(entries, uniqueNameOf(*best), file, warnings);  // throws an error that names its type
  warnIfChosen(*best, entries, std::count_if(entries.begin(), entries.end(), likelihood), warnings);
  return *best;
}

vdb::FloatGrid::Ptr toFloats(const vdb::GridBase::Ptr& grid) {
  if (auto floats = vdb::gridPtrCast<vdb::FloatGrid>(grid)) return floats;
  const auto doubles = vdb::gridPtrCast<vdb::DoubleGrid>(grid);
  auto floats = vdb::FloatGrid::create(std::make_shared<vdb::FloatTree>(doubles->tree()));
  floats->insertMeta(*doubles);
  floats->setTransform(doubles->transformPtr());
  return floats;
}

}  // namespace

void initializeVdb() {
  static std::once_flag once;
  std::call_once(once, [] {
    vdb::initialize();
    // This type is an index for values that stay on disk, and its reader trusts the stored counts. If it is not registered, it is skipped.
    vdb::Metadata::unregisterType(vdb::io::DelayedLoadMetadata::staticTypeName());
  });
}

vdb::FloatGrid::Ptr readScalarGrid(const std::filesystem::path& file, std::string bytes, const std::optional<std::string>& name,
                                   uint64_t memory_limit, Warnings& warnings) {
  initializeVdb();
  requireMemory({fmt::format("its {} bytes", bytes.size()), double(bytes.size()), "export only one grid, or larger voxels"}, memory_limit,
                file.string());
  try {
    BytesArchive archive(bytes);
    auto& entry = name ? chooseByName(archive.entries, *name, file.string(), warnings) : choose(archive.entries, file.string(), warnings);
    auto grid = toFloats(archive.load(entry));
    if (entry.descriptor.uniqueName() != entry.descriptor.gridName()) grid->setName(uniqueNameOf(entry));
    return grid;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {  // from OpenVDB or the stream
    throw InputError(file.string(), std::string("the file is damaged or truncated, or not a VDB (") + error.what() + "): export it again");
  }
}

}  // namespace cloudbake
