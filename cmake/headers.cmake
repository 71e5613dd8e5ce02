# Links some of Debian's headers into a folder, for compilers that must not see the others of /usr/include. `setup`: the command that
# installs them.
function(cloudbake_link_headers folder setup)
  file(MAKE_DIRECTORY ${folder})
  foreach(header ${ARGN})
    if(NOT EXISTS /usr/include/${header})
      message(FATAL_ERROR "/usr/include/${header} is missing: run ${setup} first")
    endif()
    file(CREATE_LINK /usr/include/${header} ${folder}/${header} SYMBOLIC)
  endforeach()
endfunction()
