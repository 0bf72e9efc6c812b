"""What all kinds of files share: result folders, journals of work that may be interrupted, where numbers come from."""
