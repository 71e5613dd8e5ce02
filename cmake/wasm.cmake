# The whole program as WebAssembly for Node: the preset node. docs/web.md, "npx cloudbake", describes what it makes.
set(CMAKE_POSITION_INDEPENDENT_CODE OFF)
set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
find_program(Python3_EXECUTABLE python3 REQUIRED NO_CMAKE_FIND_ROOT_PATH)
add_compile_options(-pthread -fwasm-exceptions -msimd128)
add_link_options(-fwasm-exceptions)
# {fmt}: kinds of numbers that nothing prints, of which one needs more than 64 bits.
add_compile_definitions(FMT_USE_LONG_DOUBLE=0 FMT_USE_INT128=0)

# Sources that are for systems with processes and sockets. What stands in for them is in X/wasm/.
set(not_in_wasm windows/ threads/ core/posix/ app/posix/allocation app/posix/signals io/file/posix/own_library io/file/posix/process
    io/file/temporary_file io/http/ app/serve pipeline/batch/schedule)
list(JOIN not_in_wasm "|/" not_in_wasm)
set(CLOUDBAKE_NOT_IN_WASM "/${not_in_wasm}")

function(cloudbake_wasm_flags)
  target_include_directories(cloudbake_flags SYSTEM BEFORE INTERFACE ${PROJECT_SOURCE_DIR}/web/libcxx)
  target_compile_options(cloudbake_flags INTERFACE -Wno-c++2b-extensions -Wno-pedantic -Wno-unused-private-field)
endfunction()

# Highway's target for WebAssembly has no vectors of double: these sources take its portable one.
set_source_files_properties(preview/backdrop/terrain_kernels.cpp preview/mesh_clouds/tone_kernels.cpp PROPERTIES
  COMPILE_DEFINITIONS HWY_COMPILE_ONLY_EMU128)

set(CLOUDBAKE_WASM_LINK -O2 CACHE STRING "How the program is linked: -O2 makes it a third smaller in three minutes, -O1 does not")

# One memory of at most 4 GB, and the functions of a library for what the program asks its host (core/wasm/host.h).
function(cloudbake_wasm_link target library)
  # where Debian has acorn, which the linker needs
  set_target_properties(${target} PROPERTIES CXX_LINKER_LAUNCHER "env;NODE_PATH=/usr/share/nodejs")
  set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${library})
  target_link_options(${target} PRIVATE ${CLOUDBAKE_WASM_LINK} -sMODULARIZE=1 -sALLOW_MEMORY_GROWTH=1 -sMAXIMUM_MEMORY=4GB
    -sINITIAL_MEMORY=32MB -sTOTAL_STACK=16MB -Wl,--stack-first,--wrap=strerror --js-library ${library} ${ARGN})
endfunction()

# The files are those of the system. The launcher, beside what the linker makes, starts the threads.
function(cloudbake_wasm_program target)
  set(cli ${PROJECT_SOURCE_DIR}/web/cli)
  set(launcher ${cli}/cloudbake.mjs ${cli}/host.mjs ${cli}/process.mjs ${cli}/thread.mjs)
  set_target_properties(${target} PROPERTIES SUFFIX ".cjs" LINK_DEPENDS "${launcher}")
  cloudbake_wasm_link(${target} ${cli}/library.js -pthread -Wno-pthreads-mem-growth
    -sDEFAULT_PTHREAD_STACK_SIZE=4MB -sEXPORT_NAME=createProgram -sENVIRONMENT=node,worker -sFILESYSTEM=0 -sWASM_BIGINT=1
    -sINVOKE_RUN=0 -sEXIT_RUNTIME=1 -sNODEJS_CATCH_EXIT=0 -sNODEJS_CATCH_REJECTION=0 -sEXPORTED_RUNTIME_METHODS=callMain,PThread)
  add_custom_command(TARGET ${target} POST_BUILD COMMAND ${CMAKE_COMMAND} -E copy ${launcher} ${PROJECT_BINARY_DIR} VERBATIM)
endfunction()

# The module of the page that bakes, with the whole program in it, which the page reads from a file beside it when it needs that.
function(cloudbake_wasm_page)
  set(web ${PROJECT_SOURCE_DIR}/web)
  add_executable(whole EXCLUDE_FROM_ALL ${web}/module.cpp)
  target_link_libraries(whole PRIVATE cloudbake_pipeline)
  target_sources(whole PRIVATE ${PROJECT_SOURCE_DIR}/third_party/serial_tbb.cpp)  # before oneTBB: such a page has no threads
  target_compile_definitions(whole PRIVATE CLOUDBAKE_WHOLE)
  cloudbake_wasm_link(whole ${web}/cli/page_library.js -sEXPORT_NAME=createEngine -sENVIRONMENT=web,worker -sFILESYSTEM=1
    -sEXPORTED_FUNCTIONS=_malloc,_free,_cloudbake_call -sEXPORTED_RUNTIME_METHODS=UTF8ToString)
  add_custom_command(
    OUTPUT ${PROJECT_BINARY_DIR}/cloudbake_whole.js
    COMMAND ${Python3_EXECUTABLE} ${web}/compose whole ${PROJECT_BINARY_DIR} ${PROJECT_BINARY_DIR}/cloudbake_whole.js
    DEPENDS whole ${web}/compose ${web}/cloudbake.js
    VERBATIM)
  add_custom_target(page_whole DEPENDS ${PROJECT_BINARY_DIR}/cloudbake_whole.js)
endfunction()
