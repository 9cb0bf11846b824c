// The tests' precompiled headers need a library with a source that is compiled with them.
