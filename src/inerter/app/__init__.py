"""The workbench: a page in the browser, and the JSON interface behind it."""
