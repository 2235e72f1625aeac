"""Weights of finite size: contact, impacts, sticking, offset track."""
