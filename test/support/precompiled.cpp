// The tests' precompiled headers belong to a library, which needs a source to be compiled.
