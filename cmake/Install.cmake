# Install rules. One tree serves `cmake --install`, the .deb packages and the tarball; it runs from any folder, because every
# path in it is relative to the program. Components: runtime, networks, dev, and python, which is in no package.
if(CMAKE_LIBRARY_ARCHITECTURE)  # which CMake takes for the prefix /usr alone
  set(CMAKE_INSTALL_LIBDIR lib/${CMAKE_LIBRARY_ARCHITECTURE} CACHE PATH "Libraries, below the prefix")
endif()
include(GNUInstallDirs)

# Libraries that only this program knows lie in a folder of their own, where the program looks for what it loads on demand
# (src/oraclegs/core/files.h).
set(ORACLEGS_PRIVATE_DIR ${CMAKE_INSTALL_LIBDIR}/oraclegs)
set_target_properties(oraclegs_core PROPERTIES INSTALL_RPATH "$ORIGIN")

install(TARGETS oraclegs_core EXPORT oraclegs LIBRARY DESTINATION ${ORACLEGS_PRIVATE_DIR} COMPONENT runtime)
include(InstallDevelopment)

if(ORACLEGS_APPS)
  cmake_path(RELATIVE_PATH ORACLEGS_PRIVATE_DIR BASE_DIRECTORY ${CMAKE_INSTALL_BINDIR} OUTPUT_VARIABLE libraries)
  set_target_properties(oraclegs PROPERTIES INSTALL_RPATH "$ORIGIN/${libraries}")
  install(TARGETS oraclegs RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
  foreach(plugin openvdb:runtime networks:networks cuda:cuda)
    string(REGEX MATCH "^([a-z]+):([a-z]+)$" matched ${plugin})
    if(TARGET oraclegs_${CMAKE_MATCH_1}_plugin)
      set_target_properties(oraclegs_${CMAKE_MATCH_1}_plugin PROPERTIES INSTALL_RPATH "$ORIGIN")
      install(TARGETS oraclegs_${CMAKE_MATCH_1}_plugin LIBRARY DESTINATION ${ORACLEGS_PRIVATE_DIR} COMPONENT ${CMAKE_MATCH_2})
    endif()
  endforeach()
  if(TARGET oraclegs_python)
    set(python lib/python3/dist-packages/oraclegs)  # where Debian's python3 looks below /usr
    cmake_path(RELATIVE_PATH ORACLEGS_PRIVATE_DIR BASE_DIRECTORY ${python} OUTPUT_VARIABLE libraries)
    set_target_properties(oraclegs_python PROPERTIES INSTALL_RPATH "$ORIGIN/${libraries}")
    install(TARGETS oraclegs_python LIBRARY DESTINATION ${python} COMPONENT python)
    install(DIRECTORY ${CMAKE_SOURCE_DIR}/python/oraclegs/ DESTINATION ${python} COMPONENT python
            FILES_MATCHING PATTERN "*.py" PATTERN py.typed)
  endif()
  if(NOT ORACLEGS_SANITIZE)  # pages come from running the program, and nobody packages this one
    include(InstallPages)
    include(Packages)
  endif()
endif()
