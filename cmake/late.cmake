# Libraries that are opened when they are needed, because what they load takes longer to load than small bakes last (late/library.h).
set(CLOUDBAKE_LATE volumes foreign server)
foreach(library ${CLOUDBAKE_LATE})
  add_library(cloudbake_${library} MODULE late/${library}.cpp late/hwy.cpp)
  target_compile_definitions(cloudbake_${library} PRIVATE CLOUDBAKE_IN_LATE_LIBRARY)
  target_link_libraries(cloudbake_${library} PRIVATE cloudbake_bake cloudbake_io)
  target_link_options(cloudbake_${library} PRIVATE LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/exports.map LINKER:--as-needed)
endforeach()
# The stand-ins come first, so the linker does not take the real functions from the rooms.
function(cloudbake_opens_late target)
  target_link_options(${target} PRIVATE LINKER:--as-needed)
  target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/late/hwy.cpp)
  target_link_libraries(${target} PRIVATE ${CMAKE_DL_LIBS})
  foreach(library ${CLOUDBAKE_LATE})
    target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/late/${library}.cpp)
    add_dependencies(${target} cloudbake_${library})
  endforeach()
endfunction()

# libcloudbake.so: pipeline/library/cloudbake.h for other programs. It exports what cmake/exports.map lists.
add_library(cloudbake_shared SHARED pipeline/library/cloudbake.cpp)
target_link_libraries(cloudbake_shared PRIVATE cloudbake_pipeline)
target_link_options(cloudbake_shared PRIVATE LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/exports.map)
set_property(TARGET cloudbake_shared APPEND PROPERTY LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/exports.map)
set_target_properties(cloudbake_shared PROPERTIES OUTPUT_NAME cloudbake EXPORT_NAME cloudbake VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
