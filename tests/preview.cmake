foreach(test camera sky noise render lit_mesh channels post mesh_clouds image_error sheet layer slab_clouds marched_clouds terrain grade)
  cloudbake_test(${test}_test cloudbake_preview)
endforeach()
# Swept lengths against plain ones.
cloudbake_test(volume_test cloudbake_preview cloudbake_bake)
cloudbake_test(image_test cloudbake_io)

# The layout of the stages, and the two Python tools that hold it and the command line.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_test(NAME check_includes COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/check_includes ${PROJECT_SOURCE_DIR})
add_test(NAME check_includes_self_test COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/check_includes --self-test)
add_test(NAME run_cases_self_test COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/tests/cli/run_cases --self-test)
