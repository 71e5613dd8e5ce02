# find_package(cloudbake) brings
#
#   cloudbake::cloudbake                            the library (cloudbake.h): triangles in, lobes out; C++20
#   cloudbake::program                              the program, as an imported executable
#   cloudbake_add_assets(NAME                       a target that bakes clouds, and again only if their inputs have changed
#     MANIFEST FILE.toml | FOLDER DIR               what to bake; relative to the source folder
#     OUTPUT_DIRECTORY DIR                          where to write; relative to the binary folder
#     [CACHE DIR]                                   bakes shared between build folders
#     [REPORT_JSON FILE] [REPORT_JUNIT FILE] [REPORT_HTML FILE]
#     [OPTIONS OPTION …]                            any other options of `cloudbake batch`, such as --rays 200
#     [ALL])                                        built by default
#
# docs/build_systems.md has an example.
if(CMAKE_VERSION VERSION_LESS 3.21)
  set(cloudbake_FOUND FALSE)
  set(cloudbake_NOT_FOUND_MESSAGE "cloudbake needs CMake 3.21 or newer, because older ones read depfiles differently")
  return()
endif()
cmake_policy(VERSION 3.21)  # for this file and its functions only; find_package does not pass it to the caller

include(${CMAKE_CURRENT_LIST_DIR}/cloudbakeLibrary.cmake)
set_property(TARGET cloudbake::cloudbake APPEND PROPERTY INTERFACE_COMPILE_FEATURES cxx_std_20)

if(NOT TARGET cloudbake::program)
  get_filename_component(_cloudbake_program ${CMAKE_CURRENT_LIST_DIR}/../../../bin/cloudbake ABSOLUTE)
  if(NOT EXISTS ${_cloudbake_program})
    set(cloudbake_FOUND FALSE)
    set(cloudbake_NOT_FOUND_MESSAGE "${_cloudbake_program} is missing: install cloudbake again")
    return()
  endif()
  add_executable(cloudbake::program IMPORTED GLOBAL)
  set_target_properties(cloudbake::program PROPERTIES IMPORTED_LOCATION ${_cloudbake_program})
  unset(_cloudbake_program)
endif()

# Stops with an error if the arguments of cloudbake_add_assets, which were parsed into arg_…, are wrong.
macro(_cloudbake_check_arguments name)
  set(usage "cloudbake_add_assets(${name}):")
  if(TARGET ${name})
    message(FATAL_ERROR "${usage} a target of this name already exists")
  endif()
  if(arg_UNPARSED_ARGUMENTS)
    list(JOIN arg_UNPARSED_ARGUMENTS " " unknown)
    message(FATAL_ERROR "${usage} unknown argument: ${unknown}. Options of `cloudbake batch` come after OPTIONS")
  endif()
  if(arg_KEYWORDS_MISSING_VALUES)
    list(JOIN arg_KEYWORDS_MISSING_VALUES ", " empty)
    message(FATAL_ERROR "${usage} no value for ${empty}")
  endif()
  if(arg_MANIFEST AND arg_FOLDER)
    message(FATAL_ERROR "${usage} MANIFEST and FOLDER exclude each other")
  endif()
  if(NOT arg_MANIFEST AND NOT arg_FOLDER)
    message(FATAL_ERROR "${usage} MANIFEST file.toml or FOLDER dir is needed: what to bake")
  endif()
  if(NOT arg_OUTPUT_DIRECTORY)
    message(FATAL_ERROR "${usage} OUTPUT_DIRECTORY dir is needed: where to write the assets")
  endif()
  foreach(option ${arg_OPTIONS})
    if(option MATCHES "^(-o|--output|--depfile|--depfile-target|--cache|--json|--junit|--html|--dry-run|--init)(=|$)")
      message(FATAL_ERROR
              "${usage} ${CMAKE_MATCH_1} cannot be in OPTIONS: use OUTPUT_DIRECTORY, CACHE and REPORT_… to say what is written where")
    endif()
  endforeach()
endmacro()

function(cloudbake_add_assets name)
  cmake_parse_arguments(PARSE_ARGV 1 arg ALL "MANIFEST;FOLDER;OUTPUT_DIRECTORY;CACHE;REPORT_JSON;REPORT_JUNIT;REPORT_HTML" OPTIONS)
  _cloudbake_check_arguments(${name})

  # Inputs are in the source folder, outputs in the binary folder.
  get_filename_component(input ${arg_MANIFEST}${arg_FOLDER} ABSOLUTE)
  if(NOT EXISTS ${input})
    message(FATAL_ERROR "${usage} ${input} does not exist")
  elseif(arg_FOLDER AND NOT IS_DIRECTORY ${input})
    message(FATAL_ERROR "${usage} ${input} is not a folder: give a manifest as MANIFEST")
  elseif(arg_MANIFEST AND IS_DIRECTORY ${input})
    message(FATAL_ERROR "${usage} ${input} is a folder: give it as FOLDER")
  endif()
  foreach(path OUTPUT_DIRECTORY CACHE REPORT_JSON REPORT_JUNIT REPORT_HTML)
    if(arg_${path})
      get_filename_component(arg_${path} ${arg_${path}} ABSOLUTE BASE_DIR ${CMAKE_CURRENT_BINARY_DIR})
    endif()
  endforeach()

  # The stamp is newer than all inputs as long as nothing has changed. It is as old as the beginning of the batch, because an input may be
  # saved while that runs; a failed batch leaves it as it was.
  set(stamp ${CMAKE_CURRENT_BINARY_DIR}/cloudbake/${name}.stamp)
  file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/cloudbake)
  set(options --depfile ${stamp}.d --depfile-target ${stamp})
  if(arg_CACHE)
    list(APPEND options --cache ${arg_CACHE})
  endif()
  set(reports "")
  foreach(kind JSON JUNIT HTML)
    if(arg_REPORT_${kind})
      string(TOLOWER --${kind} option)
      list(APPEND options ${option} ${arg_REPORT_${kind}})
      list(APPEND reports ${arg_REPORT_${kind}})
      get_filename_component(folder ${arg_REPORT_${kind}} DIRECTORY)
      file(MAKE_DIRECTORY ${folder})
    endif()
  endforeach()
  if(reports)
    list(PREPEND reports BYPRODUCTS)
  endif()

  # Makefiles add the contents of a depfile to its earlier contents (CMake 3.25), so that a removed sculpt would be missing in every build.
  set(forget "")
  if(CMAKE_GENERATOR MATCHES "Makefiles")
    set(forget COMMAND ${CMAKE_COMMAND} -E rm -f ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${name}.dir/compiler_depend.internal)
  endif()

  # A batch uses all processors and shows its progress, so it gets the terminal.
  add_custom_command(
    OUTPUT ${stamp} ${reports}
    ${forget}
    COMMAND ${CMAKE_COMMAND} -E touch ${stamp}.begun
    COMMAND cloudbake::program batch ${input} -o ${arg_OUTPUT_DIRECTORY} ${options} ${arg_OPTIONS}
    COMMAND ${CMAKE_COMMAND} -E rename ${stamp}.begun ${stamp}
    DEPENDS ${input} cloudbake::program
    DEPFILE ${stamp}.d
    COMMENT "Baking the clouds of ${name}"
    USES_TERMINAL VERBATIM)
  set(all "")
  if(arg_ALL)
    set(all ALL)
  endif()
  add_custom_target(${name} ${all} DEPENDS ${stamp})
endfunction()
