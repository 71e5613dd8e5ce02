# The pages of the viewer. Each is one file, because browsers let no page from the disk import others: esbuild joins a module and all that
# it imports to one script.
find_program(ESBUILD esbuild HINTS ${PROJECT_SOURCE_DIR}/node_modules/.bin NO_CMAKE_FIND_ROOT_PATH)
if(NOT ESBUILD)
  message(FATAL_ERROR "esbuild, which joins the scripts of pages, is missing: run scripts/setup, or install Debian's package esbuild")
endif()
file(GLOB page_modules CONFIGURE_DEPENDS viewer/*.js viewer/layers/*.js engines/npm/shade_grid.js engines/npm/swept_shadow.js
     engines/npm/sequence.js)
# Those of every page that shows clouds:
file(GLOB page_shaders CONFIGURE_DEPENDS shaders/common/*.glsl shaders/functions/*.glsl shaders/painted/*.glsl shaders/plain/*.glsl
     shaders/published/*.glsl)

# Writes viewer/page.html with a module and shaders to OUTPUT. Its marks @NAME@ are variables of the caller; SCRIPTS may have others
# already.
#   cloudbake_page(OUTPUT MODULE SHADER…)
function(cloudbake_page output module)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${module} ${page_modules} ${ARGN})
  foreach(file ${ARGN})
    cmake_path(GET file STEM LAST_ONLY name)
    file(READ ${file} text)
    string(REGEX REPLACE "[ ]*//[^\n]*" "" text "${text}")  # comments are for readers of the sources
    string(REGEX REPLACE "\n\n+" "\n" text "${text}")
    string(APPEND SCRIPTS "<script type=\"x-shader/x-fragment\" id=\"shader ${name}\">${text}</script>\n")
  endforeach()
  execute_process(COMMAND ${ESBUILD} ${module} --bundle --format=esm --minify-whitespace --charset=utf8 --log-level=warning
                  OUTPUT_VARIABLE script COMMAND_ERROR_IS_FATAL ANY)
  if(script MATCHES "</script")
    message(FATAL_ERROR "${module} has in it what ends a script")
  endif()
  string(APPEND SCRIPTS "<script type=\"module\">${script}</script>\n")
  configure_file(${PROJECT_SOURCE_DIR}/viewer/page.html ${output} @ONLY)
endfunction()
