// The tests' precompiled headers belong to a library, and need a source that is compiled with them.
