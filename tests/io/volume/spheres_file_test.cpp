#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include "io/volume/spheres.h"
#include "tests/io/io_helpers.h"

using namespace cloudbake;

// The largest block that was asked for.
static size_t largest_request = 0;

[[gnu::noinline]] void* operator new(size_t bytes) {
  largest_request = std::max(largest_request, bytes);
  if (void* block = std::malloc(bytes)) return block;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* block) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, size_t) noexcept { std::free(block); }

namespace {

using Bits = std::vector<std::array<uint32_t, 4>>;

// Equal bit by bit, signs of zero included.
Bits bitsOf(const std::vector<Sphere>& spheres) {
  Bits bits;
  for (const Sphere& s : spheres)
    bits.push_back({std::bit_cast<uint32_t>(s.center.x), std::bit_cast<uint32_t>(s.center.y), std::bit_cast<uint32_t>(s.center.z),
                    std::bit_cast<uint32_t>(s.radius)});
  return bits;
}

// Zeros of both signs, the extremes, and numbers of many digits.
std::vector<Sphere> awkwardSpheres() {
  constexpr float kMax = std::numeric_limits<float>::max(), kLeast = std::numeric_limits<float>::denorm_min();
  std::vector<Sphere> spheres{{{0, -0.0F, 1}, 1}, {{kMax, -kMax, kLeast}, kMax}, {{-kLeast, 1e-38F, 16777216}, kLeast}};
  uint32_t state = 1;
  const auto next = [&] { return std::bit_cast<float>((state = state * 1664525 + 1013904223) >> 2 | 0x20000000U); };
  for (int i = 0; i < 2000; ++i) {
    const float x = next(), y = -next(), z = next();
    spheres.push_back({{x, y, z}, next()});
  }
  return spheres;
}

// (1, 2, 3) with radius 0.5 and (−4, 5, −6) with radius 7.
const std::vector<Sphere> kTwo{{{1, 2, 3}, 0.5F}, {{-4, 5, -6}, 7}};
const std::string kTwoRows = "1 2 3 0.5\n-4 5 -6 7\n";

std::string plyHeader(const std::string& format, const std::string& radius = "pscale", const std::string& rows = "2") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + rows +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty float " + radius + "\nend_header\n";
}

template <typename T>
void append(std::string& bytes, T value, bool little_endian) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (little_endian != (std::endian::native == std::endian::little)) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

// The two spheres behind a list and a scalar of their own and elements before and after, in every type that holds them.
std::string mixedPly(bool little_endian) {
  std::string bytes = std::string("ply\nformat binary_") + (little_endian ? "little" : "big") +
                      "_endian 1.0\ncomment element vertex 9\nelement camera 1\nproperty list ushort short view\nproperty uchar kind\n"
                      "element vertex 2\nproperty double radius\nproperty list uchar int ids\nproperty short x\nproperty float Y\n"
                      "property uint id\nproperty char z\nelement face 1\nproperty list int32 uint32 vertex_indices\nend_header\n";
  const auto put = [&](auto... values) { (append(bytes, values, little_endian), ...); };
  put(uint16_t(2), int16_t(300), int16_t(400), uint8_t(1));
  put(0.5, uint8_t(1), int32_t(99), int16_t(1), 2.0F, uint32_t(1), int8_t(3));
  put(7.0, uint8_t(0), int16_t(-4), 5.0F, uint32_t(2), int8_t(-6));
  put(int32_t(3), uint32_t(0), uint32_t(1), uint32_t(0));
  return bytes;
}

const std::string kMixedText =
    "ply\r\nformat ascii 1.0\r\nelement camera 1\r\nproperty list uchar float view\r\nelement vertex 2\r\nproperty float x\r\n"
    "property list uchar int ids\r\nproperty double Z\r\nproperty int y\r\nproperty float nx\r\nproperty float32 r\r\n"
    "element face 1\r\nproperty list uchar int vertex_indices\r\nend_header\r\n2 8 9\r\n1 2 70 71 3 2 0 +0.5\r\n\r\n-4 0 -6.0e0 5 1 7\r\n"
    "3 0 1 0\r\n";

struct SpheresFile : testing::Test {
  TestFolder folder;
  Bits read(const std::string& name, const std::string& bytes) { return bitsOf(readSpheres(folder.write(name, bytes))); }
  void expectRefused(const std::string& name, const std::string& bytes, const std::string& text) {
    SCOPED_TRACE(bytes.substr(0, 400));
    expectError<InputError>([&] { readSpheres(folder.write(name, bytes)); }, text);
  }
};

}  // namespace

TEST_F(SpheresFile, GivesEveryFloatBack) {
  const auto spheres = awkwardSpheres();
  for (const char* name : {"a.ply", "a.csv"}) EXPECT_EQ(read(name, encodeSpheres(spheres, sphereFormatOf(name))), bitsOf(spheres)) << name;
}

TEST_F(SpheresFile, WritesWhatTheHeaderPromises) {
  const Sphere sphere{{1, -0.1F, 1e20F}, 0.25F};
  EXPECT_EQ(encodeSpheres({&sphere, 1}, SphereFormat::kCsv), "x,y,z,radius\n1,-0.1,1e+20,0.25\n");
  const std::string ply = encodeSpheres({&sphere, 1}, SphereFormat::kPly);
  const size_t data = ply.find("end_header\n") + 11;
  EXPECT_NE(ply.find("element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float pscale\nend_header\n"),
            std::string::npos);
  EXPECT_EQ(ply.substr(0, 36), "ply\nformat binary_little_endian 1.0\n");
  EXPECT_EQ(ply.size() - data, 16U);
  EXPECT_EQ(ply.substr(data, 4), std::string("\0\0\x80\x3F", 4));
  EXPECT_EQ(ply.substr(data + 12), std::string("\0\0\x80\x3E", 4));
}

TEST_F(SpheresFile, ChoosesTheFormatByExtension) {
  EXPECT_EQ(sphereFormatOf("a.b/c.PLY"), SphereFormat::kPly);
  EXPECT_EQ(sphereFormatOf("c.Csv"), SphereFormat::kCsv);
  expectError<UsageError>([] { sphereFormatOf("a.txt"); }, "--spheres: '.txt' is not a format for spheres: use .ply or .csv");
  expectError<UsageError>([] { sphereFormatOf("folder/ply"); }, "'folder/ply' is not a format");
  expectError<UsageError>([&] { readSpheres(folder.write("a.bgeo", "x")); }, "'.bgeo'");
}

TEST_F(SpheresFile, ReadsPlyOfEveryKind) {
  EXPECT_EQ(read("text.ply", plyHeader("ascii") + kTwoRows), bitsOf(kTwo));
  EXPECT_EQ(read("mixed.ply", kMixedText), bitsOf(kTwo));
  EXPECT_EQ(read("little.ply", mixedPly(true)), bitsOf(kTwo));
  EXPECT_EQ(read("big.ply", mixedPly(false)), bitsOf(kTwo));
}

// Every scalar type at a value that a wrong width, sign or byte order would change.
TEST_F(SpheresFile, ReadsEveryScalarType) {
  const auto expectRead = [&](const std::string& type, auto value) {
    for (const bool little_endian : {true, false}) {
      std::string bytes = std::string("ply\nformat binary_") + (little_endian ? "little" : "big") +
                          "_endian 1.0\nelement vertex 1\nproperty " + type +
                          " x\nproperty float y\nproperty float z\nproperty uchar radius\nend_header\n";
      append(bytes, value, little_endian);
      append(bytes, 2.0F, little_endian), append(bytes, 3.0F, little_endian), append(bytes, uint8_t(200), little_endian);
      EXPECT_EQ(read("a.ply", bytes), bitsOf({{{float(value), 2, 3}, 200}})) << type;
    }
  };
  for (const char* type : {"char", "int8"}) expectRead(type, int8_t(-100));
  for (const char* type : {"uchar", "uint8"}) expectRead(type, uint8_t(201));
  for (const char* type : {"short", "int16"}) expectRead(type, int16_t(-30000));
  for (const char* type : {"ushort", "uint16"}) expectRead(type, uint16_t(60001));
  for (const char* type : {"int", "int32"}) expectRead(type, int32_t(-2000000128));
  for (const char* type : {"uint", "uint32"}) expectRead(type, uint32_t(4000000000));
  for (const char* type : {"float", "float32"}) expectRead(type, 0.1F);
  for (const char* type : {"double", "float64"}) expectRead(type, -0.1);
}

TEST_F(SpheresFile, FindsTheRadiusUnderItsNames) {
  for (const char* name : {"radius", "pscale", "r", "scale", "Radius", "PScale"}) {
    EXPECT_EQ(read("a.ply", plyHeader("ascii", name) + kTwoRows), bitsOf(kTwo)) << name;
    EXPECT_EQ(read("a.csv", std::string("x,y,z,") + name + "\n1,2,3,0.5\n-4,5,-6,7\n"), bitsOf(kTwo)) << name;
  }
  // Of several names the earlier in the list counts; r beside g is red.
  EXPECT_EQ(read("a.csv", "scale,r,pscale,radius,x,y,z\n9,9,9,0.5,1,2,3\n8,8,8,7,-4,5,-6\n"), bitsOf(kTwo));
  EXPECT_EQ(read("b.csv", "scale,r,pscale,x,y,z\n9,9,0.5,1,2,3\n8,8,7,-4,5,-6\n"), bitsOf(kTwo));
  EXPECT_EQ(read("c.csv", "scale,r,x,y,z\n9,0.5,1,2,3\n8,7,-4,5,-6\n"), bitsOf(kTwo));
  EXPECT_EQ(read("d.csv", "x,y,z,r,g,b,scale\n1,2,3,0.1,0.2,0.3,0.5\n-4,5,-6,0.1,0.2,0.3,7\n"), bitsOf(kTwo));
  expectRefused("e.csv", "x,y,z,R,G,B\n1,2,3,0.1,0.2,0.3\n", ":1: there is no radius");
  expectRefused("f.csv", "x,y,z,width\n1,2,3,1\n", ":1: there is no radius");
}

TEST_F(SpheresFile, ReadsTablesOfOtherTools) {
  const std::string files[] = {
      "1,2,3,0.5\n-4,5,-6,7",                                                                        // no names, no last line end
      "\xEF\xBB\xBF\"P[x]\",\"P[y]\",\"P[z]\",\"pscale\"\r\n1,2,3,0.5\r\n-4,5,-6,7\r\n",             // Houdini's spreadsheet
      "id;name;P[0];P[1];P[2];pscale\n0;a;1;2;3;0.5\n1;\"b;c\";-4;5;-6;7\n",                         // a separator in quotes
      "Px,Py,Pz,Pscale\n1,2,3,.5\n-4,5,-6,7\n",                                                      // Houdini's Labs CSV Exporter
      "# a scatter\n\nradius\tZ\tY\tX\n  \n+0.5\t3\t2\t1\n # between\n7.0e0\t-6\t5\t-4\n",           // other order, comments, blanks
      "x, y, z, radius, note\n1, 2, 3, 0.5, \"say \"\"a, b\"\" twice\"\n-4, 5, -6, \"7\",\n,,,,\n",  // blanks, quotes, empty cells
      ",x,y,z,radius\n0,1,2,3,0.5\n1,-4,5,-6,7\n"};                                                  // pandas: an index without a name
  for (const std::string& bytes : files) EXPECT_EQ(read("a.csv", bytes), bitsOf(kTwo)) << bytes;
}

TEST_F(SpheresFile, RefusesTablesByLineAndColumn) {
  expectRefused("a.csv", "", "there are no spheres in it");
  expectRefused("a.csv", "x,y,z,radius\n\n# none\n", "there are no spheres in it");
  expectRefused("a.csv", "x,y,z,radius\n1,2,3,1\n\n1,2,3\n", ":4: 3 values in 4 columns: too few");
  expectRefused("a.csv", "x,y,z,radius\n1,2,3,1\n{1,2,3},4,5,6\n", ":3: 6 values in 4 columns: too many");
  expectRefused("a.csv", "1,2,3\n", ":1: without a line of column names there must be four columns, not 3");
  expectRefused("a.csv", "#\n1,2,3,4,5\n", ":2: without a line of column names there must be four columns, not 5");
  expectRefused("a.csv", "x,y,z,radius\n1,2,3,1\n10, two,3,1\n", ":3:5: the y of point 1 is not a number ('two')");
  expectRefused("a.csv", "1,2,a,1\n", ":1:5: the z of point 0 is not a number ('a')");
  expectRefused("a.csv", "x,y,z,radius\n1,,3,1\n", ":2:3: the y of point 0 is not a number ('')");
  expectRefused("a.csv", "x;y;z;radius\n1,5;2;3;1\n", ":2:1: the x of point 0 is not a number ('1,5')");
  expectRefused("a.csv", "x,y,z,radius\n1,2,nan,1\n", ":2:5: the z of point 0 is 'nan', which is not finite in float32");
  expectRefused("a.csv", "x,y,z,radius\n-1e39,2,3,1\n", ":2:1: the x of point 0 is '-1e39', which is not finite in float32");
  expectRefused("a.csv", "x,y,z,radius\n1,2,3,inf\n", ":2:7: the radius of point 0 is 'inf', which is not finite in float32");
  for (const char* radius : {"0", "-0", "-2.5", "1e-60"})
    expectRefused("a.csv", std::string("x,y,z,radius\n1,2,3,1\n1,2,3,") + radius + "\n", ":3:7: the radius of point 1 is not above 0");
  expectRefused("a.csv", "# points\nx,y,z,mass\n1,2,3,1\n", ":2: there is no radius; give every point a radius: pscale or radius");
  expectRefused("a.csv", "x,z,radius\n1,2,3\n", ":1: there is no column 'y'");
}

TEST_F(SpheresFile, RefusesPlyByLineOrPoint) {
  const std::string text = plyHeader("ascii");
  expectRefused("a.ply", "", "a PLY must begin with 'ply'");
  expectRefused("a.ply", plyHeader("ascii", "pscale", "0"), "there are no spheres in it");
  expectRefused("a.ply", text + "1 2 3 1\n1 2 3\n", ":10: a row has fewer values");
  expectRefused("a.ply", text + "1 2 3 1\n10 a 3 1\n", ":10:4: the y of point 1 is not a number ('a')");
  expectRefused("a.ply", text + "1 2 3 1\n1 2 -inf 1\n", ":10:5: the z of point 1 is '-inf', which is not finite in float32");
  expectRefused("a.ply", text + "1 2 3 0\n1 2 3 1\n", ":9:7: the radius of point 0 is not above 0");
  expectRefused("a.ply", plyHeader("ascii", "mass") + kTwoRows, ":3: there is no radius; give every point a radius");
  expectRefused("a.ply", "ply\nformat ascii 1.0\nelement point 1\nproperty float x\nend_header\n1\n",
                ":5: the PLY has no element 'vertex'");
  expectRefused("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty list uchar float y\nend_header\n1 1 2\n",
                ":3: there is no column 'y'");

  std::string binary = plyHeader("binary_big_endian");
  for (const float value : {1.0F, 2.0F, 3.0F, 1.0F, 1.0F, 2.0F, 3.0F}) append(binary, value, false);
  std::string zero = binary, nan = binary, huge = binary;
  append(zero, -1.0F, false), append(nan, NAN, false);
  const auto message = [&](const std::string& bytes) {
    try {
      readSpheres(folder.write("b.ply", bytes));
    } catch (const InputError& error) {
      EXPECT_EQ(error.line, 0);
      return error.message;
    }
    return std::string("nothing was thrown");
  };
  EXPECT_EQ(message(zero), "the radius of point 1 is not above 0; give the point a radius or remove it");
  EXPECT_EQ(message(nan), "the radius of point 1 is not finite in float32; repair the point or remove it");
  expectError<IoError>([&] { readSpheres(folder.path / "none.ply"); }, "No such file");
  expectError<IoError>([&] { readSpheres(folder.path / "none.csv"); }, "No such file");
}

TEST_F(SpheresFile, BelievesNoCountBeforeTheRowsAreThere) {
  const std::string row(16, '\x3F');
  largest_request = 0;
  for (const char* format : {"binary_little_endian", "binary_big_endian"})
    expectRefused("a.ply", plyHeader(format, "pscale", "4000000000") + row, "the PLY ends after 1 of 4000000000 rows");
  expectRefused("a.ply", plyHeader("ascii", "pscale", "4000000000") + kTwoRows, "the PLY ends after 2 of 4000000000 rows");
  expectRefused("a.ply", "ply\nformat ascii 1.0\nelement nothing 4000000000\n" + plyHeader("ascii").substr(21) + kTwoRows,
                "rows but no properties");
  EXPECT_LT(largest_request, 100'000U);
}

TEST_F(SpheresFile, HoldsToTheLimit) {
  EXPECT_EQ(kMaxSpheres, 10'000'000U);
  const auto csv = folder.write("a.csv", "x,y,z,radius\n1,2,3,1\n1,2,3,1\n1,2,3,1\n");
  EXPECT_EQ(readSpheres(csv, 3).size(), 3U);
  expectError<InputError>([&] { readSpheres(csv, 2); }, ":4: there are more than 2 spheres; export fewer points");
  const auto ply = folder.write("a.ply", encodeSpheres(kTwo, SphereFormat::kPly));
  EXPECT_EQ(readSpheres(ply, 2).size(), 2U);
  expectError<InputError>([&] { readSpheres(ply, 1); }, "there are more than 1 spheres");
}

// A PLY is refused at every cut, but for its last line's own end and digits; a table gives whole rows, but for the digits of its last.
TEST_F(SpheresFile, SurvivesEveryTruncation) {
  const std::string text = plyHeader("ascii") + kTwoRows;
  for (const std::string& bytes : {encodeSpheres(kTwo, SphereFormat::kPly), mixedPly(true), mixedPly(false), text, kMixedText})
    for (size_t size = 0; size < bytes.size() - (bytes.find("ascii") < bytes.size() ? 3 : 0); ++size)
      expectRefused("cut.ply", bytes.substr(0, size), "cut.ply");

  const std::string csv = encodeSpheres(awkwardSpheres(), SphereFormat::kCsv).substr(0, 500);
  const Bits whole = bitsOf(awkwardSpheres());
  for (size_t size = 0; size < csv.size(); ++size) {
    const size_t rows = size_t(std::count(csv.begin(), csv.begin() + std::ptrdiff_t(size), '\n'));
    try {
      const Bits part = read("cut.csv", csv.substr(0, size));
      ASSERT_TRUE(part.size() + 1 == rows || part.size() == rows) << size;
      EXPECT_TRUE(std::equal(part.begin(), part.begin() + std::ptrdiff_t(rows) - 1, whole.begin())) << size;
    } catch (const InputError& error) {
      EXPECT_TRUE(rows < 2 || csv[size - 1] != '\n') << size << ": " << error.what();
    }
  }
}
