foreach(test expression grammar derive domain turtle spheres recipe)
  cloudbake_test(${test}_test cloudbake_lsystem)
endforeach()
