foreach(test mesh_topology shells self_intersections thin_parts winding billow_noise sphere_field level_set surface surface_error directions inside_length sphere_rays reference error_metrics repair fit_lobe peers
             coverage smooth_lobes harmonics sweep dense_field march_kernels simd_targets)
  cloudbake_test(${test}_test cloudbake_bake)
endforeach()

# Which targets bake/ was compiled for depends on this (see CMakeLists.txt).
target_compile_definitions(simd_targets_test PRIVATE HWY_BROKEN_EMU128=0)

# The same bytes where glibc takes its functions for CPUs without FMA and AVX2.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_test(NAME same_under_tunables COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/cli/same_under_tunables
         $<TARGET_FILE:sweep_test> $<TARGET_FILE:simd_targets_test>)
