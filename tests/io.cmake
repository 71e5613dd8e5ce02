foreach(test write_file manifest find_files read_mesh child_reader gltf report batch_report plot curve spheres_file lattice validate_asset exr)
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

# Python's readers of XML, HTML and JSON (and jsonschema, where it is installed) read what batch_report_test wrote.
set(CLOUDBAKE_BATCH_FOLDER ${CMAKE_CURRENT_BINARY_DIR}/batch)
target_compile_definitions(batch_report_test PRIVATE CLOUDBAKE_BATCH_FOLDER="${CLOUDBAKE_BATCH_FOLDER}")
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_test(NAME batch_files COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/cli/batch_files ${CLOUDBAKE_BATCH_FOLDER} ${PROJECT_SOURCE_DIR}/docs/batch_report.schema.json)
set_tests_properties(batch_report_test PROPERTIES FIXTURES_SETUP batch_files)
set_tests_properties(batch_files PROPERTIES FIXTURES_REQUIRED batch_files)
