# Compiles through ccache when it is installed. The sloppiness lets objects that use the precompiled header be cached;
# the base directory lets a second clone of the project reuse the first one's objects.
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(ccache_settings CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
                      CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env ${ccache_settings} ${CCACHE_PROGRAM})
  # A precompiled header is known by the bytes of what it was made of, never by what the preprocessor makes of them: that
  # reads the old one where there is one, and drops comments, by which GCC does tell whether a header is the one it has.
  set(ORACLEGS_CCACHE_OF_HEADERS ${CMAKE_COMMAND} -E env ${ccache_settings} CCACHE_DEPEND=1 ${CCACHE_PROGRAM})
  # Clang keeps the times of headers in it instead, by which a second build refuses the one out of the cache.
  add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess>
                      "$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endif()
