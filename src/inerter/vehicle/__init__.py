"""Mechanisms, and vehicle models based on them."""
