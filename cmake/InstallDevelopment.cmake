# The CMake package: find_package(oraclegs) gives oraclegs::render, oraclegs::train and the other floors that need no program
# (ORACLEGS_ENGINE, what -DORACLEGS_APPS=OFF builds), with their headers below include/oraclegs.
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/oraclegs)
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/oraclegs)

foreach(floor ${ORACLEGS_ENGINE})
  set_target_properties(oraclegs_${floor} PROPERTIES EXPORT_NAME ${floor})
  target_include_directories(oraclegs_${floor} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(oraclegs_${floor} INTERFACE $<INSTALL_INTERFACE:cxx_std_20>)
  if(NOT floor STREQUAL core)  # with the program
    install(TARGETS oraclegs_${floor} EXPORT oraclegs ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
  endif()
  # Device code is no interface.
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/src/oraclegs/${floor} DESTINATION ${headers} COMPONENT dev
          FILES_MATCHING PATTERN "*.h" PATTERN "cuda" EXCLUDE)
endforeach()
install(FILES ${CMAKE_BINARY_DIR}/generated/oraclegs/core/config.h DESTINATION ${headers}/core COMPONENT dev)

# What they link through pkg-config, as pairs of the target's name and the module's, for the config file.
set(modules "")
foreach(floor ${ORACLEGS_ENGINE})
  get_target_property(linked oraclegs_${floor} LINK_LIBRARIES)
  list(FILTER linked INCLUDE REGEX "^PkgConfig::")
  list(TRANSFORM linked REPLACE "^PkgConfig::" "")
  foreach(name ${linked})
    list(APPEND modules "${name}=${${name}_MODULE_NAME}")
  endforeach()
endforeach()
list(REMOVE_DUPLICATES modules)

install(EXPORT oraclegs NAMESPACE oraclegs:: FILE oraclegs-targets.cmake DESTINATION ${package} COMPONENT dev)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/oraclegs-config.cmake.in ${CMAKE_BINARY_DIR}/oraclegs-config.cmake
                              INSTALL_DESTINATION ${package})
# Before 1.0 every minor version may change the interface.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/oraclegs-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/oraclegs-config.cmake ${CMAKE_BINARY_DIR}/oraclegs-config-version.cmake
        DESTINATION ${package} COMPONENT dev)
