// Vite before 8 must be told that a worker may have chunks, which ctsn has.
export default { worker: { format: 'es' } };
