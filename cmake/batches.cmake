# Compiles several sources as one, because headers take most of the compile time of small ones. All names in the files of a batch must
# differ. CMake's own unity builds name the files by absolute paths, so that ccache would not share the objects between checkouts.

# Sources with macros, options or targets of their own, those that have stand-ins (late/), and those that take longest, as regular
# expressions: they are compiled alone.
set(CLOUDBAKE_APART bake/.+ preview/.+_kernels.cpp preview/compare/lettering.cpp io/gltf/tinygltf.cpp io/image/image.cpp
    io/sculpt/sculpt_images.cpp
    io/sculpt/delaunay_polygon.cpp io/file/write_file.cpp io/http/page_server.cpp io/sculpt/read_assimp.cpp io/sculpt/assimp_materials.cpp
    io/volume/vdb.*.cpp
                    pipeline/options/version.cpp pipeline/library/cloudbake.cpp)

# Replaces the sources in the list that `list_name` names by batches of at most `size` files of one folder. `name` is the target's.
function(cloudbake_batches list_name name size)
  list(JOIN CLOUDBAKE_APART "|" apart)
  set(compiled ${${list_name}})
  list(FILTER compiled INCLUDE REGEX "^${PROJECT_SOURCE_DIR}/(${apart})$")
  set(waiting ${${list_name}})
  list(REMOVE_ITEM waiting "" ${compiled})
  list(TRANSFORM waiting REPLACE "^${PROJECT_SOURCE_DIR}/" "")
  while(waiting)
    list(GET waiting 0 first)
    cmake_path(GET first PARENT_PATH folder)
    set(batch ${waiting})
    list(FILTER batch INCLUDE REGEX "^${folder}/[^/]+$")
    list(SUBLIST batch 0 ${size} batch)
    list(REMOVE_ITEM waiting ${batch})
    list(TRANSFORM batch REPLACE ".+" "#include \"\\0\"")
    list(JOIN batch "\n" text)
    list(LENGTH compiled number)
    # GCC takes the anonymous namespace of a file that is included for that of a header.
    string(PREPEND text "#pragma GCC diagnostic ignored \"-Wsubobject-linkage\"\n")
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/batches/${name}/batch_${number}.cpp CONTENT "${text}\n" @ONLY)
    list(APPEND compiled ${PROJECT_BINARY_DIR}/batches/${name}/batch_${number}.cpp)
  endwhile()
  set(${list_name} ${compiled} PARENT_SCOPE)
endfunction()
