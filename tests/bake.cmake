foreach(test mesh_topology winding level_set surface directions inside_length sphere_rays reference error_metrics repair fit_lobe peers)
  cloudbake_test(${test}_test cloudbake_bake)
endforeach()
