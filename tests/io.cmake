foreach(test write_file read_mesh child_reader gltf report plot curve spheres_file)
  cloudbake_test(${test}_test cloudbake_io)
endforeach()
cloudbake_test(vdb_test cloudbake_io cloudbake_bake)

# The Khronos validator checks every GLB that gltf_test wrote. Node and the package come from scripts/setup; without them it fails.
set(CLOUDBAKE_GLB_FOLDER ${CMAKE_CURRENT_BINARY_DIR}/glb)
target_compile_definitions(gltf_test PRIVATE CLOUDBAKE_GLB_FOLDER="${CLOUDBAKE_GLB_FOLDER}")
add_test(NAME gltf_validator COMMAND node ${CMAKE_CURRENT_SOURCE_DIR}/gltf_validator/validate.mjs ${CLOUDBAKE_GLB_FOLDER})
set_tests_properties(gltf_test PROPERTIES FIXTURES_SETUP glb_files)
set_tests_properties(gltf_validator PROPERTIES FIXTURES_REQUIRED glb_files)
set_tests_properties(read_mesh_test child_reader_test PROPERTIES ENVIRONMENT LSAN_OPTIONS=suppressions=${CMAKE_CURRENT_SOURCE_DIR}/data/lsan_assimp.supp)
