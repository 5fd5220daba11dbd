# What the program brings besides itself: pages that it prints, documents, notices of others' code.

# oraclegs_page(FILE FOLDER ARGUMENTS...): FOLDER/FILE holds what `oraclegs ARGUMENTS` prints after a build.
set(pages ${CMAKE_BINARY_DIR}/share)
file(MAKE_DIRECTORY ${pages})
set(made "")
macro(oraclegs_page file folder)
  add_custom_command(OUTPUT ${pages}/${file} COMMAND oraclegs ${ARGN} > ${pages}/${file}.part
                     COMMAND ${CMAKE_COMMAND} -E rename ${pages}/${file}.part ${pages}/${file}
                     DEPENDS oraclegs COMMENT "oraclegs ${ARGN}" VERBATIM)
  install(FILES ${pages}/${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/${folder} COMPONENT runtime)
  list(APPEND made ${pages}/${file})
endmacro()
oraclegs_page(oraclegs bash-completion/completions completion bash)
oraclegs_page(_oraclegs zsh/vendor-completions completion zsh)
oraclegs_page(oraclegs.fish fish/vendor_completions.d completion fish)
set(manual ${pages}/oraclegs.1)
add_custom_command(OUTPUT ${manual}.gz COMMAND oraclegs man > ${manual} COMMAND gzip -9nf ${manual}
                   DEPENDS oraclegs COMMENT "oraclegs man" VERBATIM)
# The entry in the menu of a desktop: the app.
install(FILES ${CMAKE_SOURCE_DIR}/packaging/oraclegs.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT runtime)
install(FILES ${CMAKE_SOURCE_DIR}/packaging/oraclegs.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps
        COMPONENT runtime)
install(FILES ${manual}.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
list(APPEND made ${manual}.gz)

# What is linked and under which licenses, read from what was built.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(notices ${pages}/THIRD_PARTY_NOTICES.md)
set(linked oraclegs oraclegs_core)
foreach(plugin oraclegs_openvdb_plugin oraclegs_networks_plugin)
  if(TARGET ${plugin})
    list(APPEND linked ${plugin})
  endif()
endforeach()
set(linked_files "")
foreach(target ${linked})
  list(APPEND linked_files $<TARGET_FILE:${target}>)
endforeach()
set(notices_script ${CMAKE_SOURCE_DIR}/packaging/third_party_notices.py)
add_custom_command(OUTPUT ${notices}
                   COMMAND ${Python3_EXECUTABLE} ${notices_script} --source ${CMAKE_SOURCE_DIR} -o ${notices} ${linked_files}
                   DEPENDS ${linked} ${notices_script} COMMENT "Third-party notices" VERBATIM)
list(APPEND made ${notices})
add_custom_target(oraclegs_pages ALL DEPENDS ${made})

install(FILES ${notices} ${CMAKE_SOURCE_DIR}/README.md ${CMAKE_SOURCE_DIR}/CHANGELOG.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(FILES ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime
        FILES_MATCHING PATTERN "*.md" PATTERN images EXCLUDE)
