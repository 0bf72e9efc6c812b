"""All compiled code, on plain arrays: to import it loads no compiler, compiles nothing and starts no process."""
