foreach(test camera sky render)
  cloudbake_test(${test}_test cloudbake_preview)
endforeach()
cloudbake_test(image_test cloudbake_io)
