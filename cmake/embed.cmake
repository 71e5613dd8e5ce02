# Files as one generated source of TARGET: OUTPUT defines FUNCTION of HEADER, which gives the span of TYPE {name, text} of FILES, whose
# paths lose what matches WITHOUT.
function(cloudbake_embed target output header type function without)
  set(entries "")
  foreach(file ${ARGN})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE name)
    string(REGEX REPLACE "${without}" "" name ${name})
    file(READ ${file} text)
    string(APPEND entries "    {\"${name}\", R\"embedded(${text})embedded\"},\n")
  endforeach()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${output} @ONLY CONTENT [[#include "@header@"

namespace cloudbake {

std::span<const @type@> @function@() {
  static constexpr @type@ kFiles[] = {
@entries@  };
  return kFiles;
}

}  // namespace cloudbake
]])
  target_sources(${target} PRIVATE ${PROJECT_BINARY_DIR}/${output})
endfunction()

# The same of files that are no text: the spans of bytes are `static constexpr unsigned char`, and TYPE is {name, bytes}.
function(cloudbake_embed_bytes target output header type function without)
  set(arrays "")
  set(entries "")
  foreach(file ${ARGN})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE name)
    string(REGEX REPLACE "${without}" "" name ${name})
    file(READ ${file} bytes HEX)
    string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
    list(LENGTH arrays index)
    list(APPEND arrays "constexpr unsigned char kBytes${index}[] = {${bytes}}")
    string(APPEND entries "    {\"${name}\", kBytes${index}},\n")
  endforeach()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${output} @ONLY CONTENT [[#include "@header@"

namespace cloudbake {

namespace {
@arrays@;
}  // namespace

std::span<const @type@> @function@() {
  static constexpr @type@ kFiles[] = {
@entries@  };
  return kFiles;
}

}  // namespace cloudbake
]])
  target_sources(${target} PRIVATE ${PROJECT_BINARY_DIR}/${output})
endfunction()
