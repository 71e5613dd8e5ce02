# The contents of an installation: the program, its man page and completions, the documents and the CMake package. Also the Debian package.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The program itself prints its commands and options.
find_program(GZIP gzip REQUIRED)
set(docs_dir ${PROJECT_BINARY_DIR}/print_docs)
file(MAKE_DIRECTORY ${docs_dir})
set(schema_files ${docs_dir}/manifest.schema.json ${docs_dir}/recipe.schema.json)
set(docs_files ${docs_dir}/cloudbake.1.gz ${docs_dir}/cloudbake ${docs_dir}/_cloudbake ${docs_dir}/cloudbake.fish ${schema_files})
add_custom_command(
  OUTPUT ${docs_files}
  COMMAND cloudbake print-docs man > cloudbake.1
  COMMAND ${GZIP} -9nf cloudbake.1
  COMMAND cloudbake print-docs bash > cloudbake
  COMMAND cloudbake print-docs zsh > _cloudbake
  COMMAND cloudbake print-docs fish > cloudbake.fish
  COMMAND cloudbake print-docs manifest-schema > manifest.schema.json
  COMMAND cloudbake print-docs recipe-schema > recipe.schema.json
  DEPENDS cloudbake
  WORKING_DIRECTORY ${docs_dir}
  COMMENT "Writing the man page, the completions and the schemas"
  VERBATIM)
add_custom_target(cloudbake_docs ALL DEPENDS ${docs_files})

# What is not built yet is named, with the command that builds it.
set(late_libraries ${CLOUDBAKE_LATE})
list(TRANSFORM late_libraries PREPEND cloudbake_)
list(TRANSFORM late_libraries REPLACE ".+" "$<TARGET_FILE:\\0>" OUTPUT_VARIABLE late_files)
set(install_needs $<TARGET_FILE:cloudbake> $<TARGET_FILE:cloudbake_shared> ${late_files} ${docs_files} ${PROJECT_BINARY_DIR}/engines/written
    ${PROJECT_BINARY_DIR}/cloudbake_blender.zip)
if(CLOUDBAKE_PYTHON)
  list(APPEND install_needs $<TARGET_FILE:cloudbake_python>)
endif()
install(CODE "set(needs \"${install_needs}\")
foreach(file IN LISTS needs)
  if(NOT EXISTS \"\${file}\")
    message(FATAL_ERROR \"\${file} is not built yet: run cmake --build ${PROJECT_BINARY_DIR} first\")
  endif()
endforeach()" ALL_COMPONENTS)

install(TARGETS cloudbake)
install(TARGETS ${late_libraries} LIBRARY DESTINATION lib)
# The library, with the headers that its own header needs.
install(TARGETS cloudbake_shared EXPORT cloudbakeLibrary LIBRARY DESTINATION lib INCLUDES DESTINATION include/cloudbake)
install(FILES pipeline/library/cloudbake.h DESTINATION include/cloudbake)
install(FILES core/affine.h core/error.h core/lobe_lighting.h core/portable_math.h core/types.h core/vec3.h core/warnings.h
        DESTINATION include/cloudbake/core)
# The Python module. Debian's Python looks into lib/python3/dist-packages below /usr; elsewhere PYTHONPATH leads to it.
if(CLOUDBAKE_PYTHON)
  set(CLOUDBAKE_PYTHON_FOLDER lib/python3/dist-packages CACHE STRING "Folder below the prefix that the Python module is installed into")
  install(TARGETS cloudbake_python LIBRARY DESTINATION ${CLOUDBAKE_PYTHON_FOLDER}/cloudbake)
  install(DIRECTORY python/cloudbake DESTINATION ${CLOUDBAKE_PYTHON_FOLDER} FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN "py.typed"
          PATTERN "__pycache__" EXCLUDE)
endif()
install(EXPORT cloudbakeLibrary NAMESPACE cloudbake:: DESTINATION lib/cmake/cloudbake)
install(FILES ${docs_dir}/cloudbake.1.gz DESTINATION share/man/man1)
install(FILES ${docs_dir}/cloudbake DESTINATION share/bash-completion/completions)
install(FILES ${docs_dir}/cloudbake.fish DESTINATION share/fish/vendor_completions.d)
install(FILES ${schema_files} DESTINATION share/cloudbake)
install(FILES ${docs_dir}/_cloudbake DESTINATION share/zsh/site-functions COMPONENT site)
file(GLOB pages CONFIGURE_DEPENDS docs/*.md)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md SECURITY.md LICENSE NOTICE DESTINATION share/doc/cloudbake)
install(FILES ${pages} DESTINATION share/doc/cloudbake/docs)
file(GLOB engine_pages CONFIGURE_DEPENDS docs/engines/*.md)
install(FILES ${engine_pages} DESTINATION share/doc/cloudbake/docs/engines)

# The engine kit with its default constants; `cloudbake shader` writes it with those of an asset.
set(kit_dir ${PROJECT_BINARY_DIR}/engines)
set(kit_engines ${kit_files})
list(FILTER kit_engines INCLUDE REGEX "^${PROJECT_SOURCE_DIR}/engines/[^/]+/")
list(TRANSFORM kit_engines REPLACE "^${PROJECT_SOURCE_DIR}/engines/" "")
list(TRANSFORM kit_engines REPLACE "/.*" "")
list(REMOVE_DUPLICATES kit_engines)
set(write_kit COMMAND ${CMAKE_COMMAND} -E rm -rf ${kit_dir})
foreach(engine ${kit_engines})
  list(APPEND write_kit COMMAND cloudbake shader ${engine} -q -o ${kit_dir}/${engine})
endforeach()
add_custom_command(OUTPUT ${kit_dir}/written ${write_kit} COMMAND ${CMAKE_COMMAND} -E touch ${kit_dir}/written DEPENDS cloudbake
                   COMMENT "Writing the engine kit" VERBATIM)
add_custom_target(cloudbake_kit ALL DEPENDS ${kit_dir}/written)
install(DIRECTORY ${kit_dir} DESTINATION share/cloudbake PATTERN written EXCLUDE)

# The add-on for Blender as an archive that Blender installs. scripts/package_addon needs only Python.
if(NOT CLOUDBAKE_SYSTEM_PYTHON)
  message(FATAL_ERROR "python3 is not on the PATH: install it, because it packs the add-on for Blender")
endif()
file(GLOB addon_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/blender/cloudbake_addon/*)
list(FILTER addon_sources EXCLUDE REGEX "/__pycache__$|/bin$")
set(addon_archive ${PROJECT_BINARY_DIR}/cloudbake_blender.zip)
add_custom_command(
  OUTPUT ${addon_archive}
  COMMAND ${CLOUDBAKE_SYSTEM_PYTHON} ${PROJECT_SOURCE_DIR}/scripts/package_addon -o ${addon_archive}
  DEPENDS ${addon_sources} ${PROJECT_SOURCE_DIR}/scripts/package_addon
  COMMENT "Packing the add-on for Blender"
  VERBATIM)
add_custom_target(blender_addon ALL DEPENDS ${addon_archive})
install(FILES ${addon_archive} DESTINATION share/cloudbake)

# find_package(cloudbake): nothing in it depends on where it is installed.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cloudbakeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/cloudbakeConfig.cmake ${PROJECT_BINARY_DIR}/cloudbakeConfigVersion.cmake DESTINATION lib/cmake/cloudbake)

# cpack -G DEB. Debian has its own folder for packages' zsh completions, and requires the licence in a file named copyright.
set(binary_licence "the Apache License, Version 2.0, as its source code.")
if(CLOUDBAKE_CGAL)
  string(CONCAT binary_licence
      "the GNU General Public License, version 3 or later, because it is built with\n"
      "packages of CGAL. Debian keeps that licence in /usr/share/common-licenses/GPL-3.")
endif()
configure_file(cmake/copyright.in ${PROJECT_BINARY_DIR}/copyright @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/copyright DESTINATION share/doc/cloudbake COMPONENT debian EXCLUDE_FROM_ALL)
install(FILES ${schema_files} DESTINATION share/cloudbake)
install(FILES ${docs_dir}/_cloudbake DESTINATION share/zsh/vendor-completions COMPONENT debian EXCLUDE_FROM_ALL)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};cloudbake;Unspecified;/;${PROJECT_BINARY_DIR};cloudbake;debian;/")

set(CLOUDBAKE_MAINTAINER "cloudbake maintainers <maintainers@cloudbake.invalid>" CACHE STRING "Maintainer that the Debian package names")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME cloudbake)
set(CPACK_PACKAGE_VENDOR cloudbake)
set(CPACK_PACKAGE_CONTACT "${CLOUDBAKE_MAINTAINER}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "python3-numpy")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "offline baker of mesh clouds
cloudbake grows clouds with an L-system, or takes an artist's sculpt as it is,
measures how much cloud lies in every direction from every vertex, and writes
glTF: where the cloud's bulk lies and how thick it is there, four floats in
two UV channels, from which a shader lights the cloud with one pow and one exp
per light.")
include(CPack)
