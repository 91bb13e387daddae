module sparse_matrix
  !! A global matrix in compressed columns and the addition of element matrices to it.
  !!
  !! Block (a,b) of an element matrix, K(i,k) = ke(i,a,k,b), goes to
  !!     values(colptr(eq(k,b)) + offset(a,b) + i' - [symmetric] k' + 1),
  !! where i' and k' count the free components of nodes a and b from 0. Components with eq <= 0 are skipped; an
  !! element's components are the first ndf ones of its nodes.
  use kinds, only: wp
  use status_codes, only: ok, stale_pattern
  use sparse_pattern, only: sparse_pattern_type, not_in_pattern
  implicit none (type, external)
  private
  public :: sparse_matrix_type, set_zero, scatter_block_matrix, scatter_unsymmetric_matrix, scatter_linked_matrix, &
    multiply, matrix_entry, largest_diagonal, largest_offdiagonal

  type :: sparse_matrix_type
    type(sparse_pattern_type) :: pattern
    real(wp), allocatable :: values(:)  !! (nnz)
  end type sparse_matrix_type

contains

  pure subroutine set_zero(matrix)
    !! All entries zero; the values are allocated anew where the pattern has changed.
    type(sparse_matrix_type), intent(inout) :: matrix

    if (allocated(matrix%values)) then
      if (size(matrix%values) /= matrix%pattern%nnz) deallocate (matrix%values)
    end if
    if (.not. allocated(matrix%values)) allocate (matrix%values(matrix%pattern%nnz))
    matrix%values = 0
  end subroutine set_zero

  pure subroutine scatter_block_matrix(matrix, ndf, nen, eq, offset, ke, status)
    !! Add a symmetric element matrix of which the blocks a >= b are given.
    type(sparse_matrix_type), intent(inout) :: matrix
    integer, intent(in) :: ndf, nen
    integer, intent(in) :: eq(ndf, nen)               !! equations of the components, <= 0: none
    integer, intent(in) :: offset(nen, nen)           !! from locate_blocks or locate_lists
    real(wp), intent(in) :: ke(ndf, nen, ndf, nen)    !! each block complete
    integer, intent(out) :: status                    !! ok, stale_pattern (the missing blocks are left out)

    associate (pattern => matrix%pattern)
      if (.not. pattern%symmetric) then
        call add_full(ndf, nen, .true., pattern%colptr, eq, offset, ke, matrix%values, status)
      else if (any(eq <= 0)) then
        call lower_some(ndf, nen, pattern%colptr, eq, offset, ke, matrix%values, status)
      else if (ndf == 2) then
        call lower_all_2(nen, pattern%colptr, eq, offset, ke, matrix%values, status)
      else if (ndf == 3) then
        call lower_all_3(nen, pattern%colptr, eq, offset, ke, matrix%values, status)
      else
        call lower_some(ndf, nen, pattern%colptr, eq, offset, ke, matrix%values, status)
      end if
    end associate
  end subroutine scatter_block_matrix

  pure subroutine scatter_unsymmetric_matrix(matrix, ndf, nen, eq, offset, ke, status)
    !! Add an element matrix of which all blocks are given; the matrix must hold both triangles.
    type(sparse_matrix_type), intent(inout) :: matrix
    integer, intent(in) :: ndf, nen
    integer, intent(in) :: eq(ndf, nen)               !! equations of the components, <= 0: none
    integer, intent(in) :: offset(nen, nen)           !! from locate_blocks or locate_lists
    real(wp), intent(in) :: ke(ndf, nen, ndf, nen)
    integer, intent(out) :: status                    !! ok, stale_pattern (the missing blocks are left out)

    if (matrix%pattern%symmetric) error stop 'scatter_unsymmetric_matrix: the matrix holds one triangle only'
    call add_full(ndf, nen, .false., matrix%pattern%colptr, eq, offset, ke, matrix%values, status)
  end subroutine scatter_unsymmetric_matrix

  pure subroutine lower_all_2(nen, colptr, eq, offset, ke, values, status)
    !! Two components a node, all of them free: the usual element in two dimensions.
    integer, intent(in) :: nen
    integer, intent(in) :: colptr(*), eq(2, nen), offset(nen, nen)
    real(wp), intent(in) :: ke(2, nen, 2, nen)
    real(wp), intent(inout) :: values(*)
    integer, intent(out) :: status
    integer :: a, b, p, q, o

    status = ok
    do b = 1, nen
      p = colptr(eq(1, b)) + 1
      q = colptr(eq(2, b))
      values(p) = values(p) + ke(1, b, 1, b)
      values(p + 1) = values(p + 1) + ke(2, b, 1, b)
      values(q + 1) = values(q + 1) + ke(2, b, 2, b)
      do a = b + 1, nen
        o = offset(a, b)
        if (o > 0) then
          values(p + o) = values(p + o) + ke(1, a, 1, b)
          values(p + o + 1) = values(p + o + 1) + ke(2, a, 1, b)
          values(q + o) = values(q + o) + ke(1, a, 2, b)
          values(q + o + 1) = values(q + o + 1) + ke(2, a, 2, b)
        else
          call lower_pair(2, nen, a, b, colptr, eq, offset, ke, values, status)
        end if
      end do
    end do
  end subroutine lower_all_2

  pure subroutine lower_all_3(nen, colptr, eq, offset, ke, values, status)
    !! Three components a node, all of them free.
    integer, intent(in) :: nen
    integer, intent(in) :: colptr(*), eq(3, nen), offset(nen, nen)
    real(wp), intent(in) :: ke(3, nen, 3, nen)
    real(wp), intent(inout) :: values(*)
    integer, intent(out) :: status
    integer :: a, b, p, q, r, o

    status = ok
    do b = 1, nen
      p = colptr(eq(1, b)) + 1
      q = colptr(eq(2, b))
      r = colptr(eq(3, b)) - 1
      values(p:p + 2) = values(p:p + 2) + ke(:, b, 1, b)
      values(q + 1:q + 2) = values(q + 1:q + 2) + ke(2:3, b, 2, b)
      values(r + 2) = values(r + 2) + ke(3, b, 3, b)
      do a = b + 1, nen
        o = offset(a, b)
        if (o > 0) then
          values(p + o:p + o + 2) = values(p + o:p + o + 2) + ke(:, a, 1, b)
          values(q + o:q + o + 2) = values(q + o:q + o + 2) + ke(:, a, 2, b)
          values(r + o:r + o + 2) = values(r + o:r + o + 2) + ke(:, a, 3, b)
        else
          call lower_pair(3, nen, a, b, colptr, eq, offset, ke, values, status)
        end if
      end do
    end do
  end subroutine lower_all_3

  pure subroutine lower_some(ndf, nen, colptr, eq, offset, ke, values, status)
    !! Any number of components, some of them without an equation.
    integer, intent(in) :: ndf, nen
    integer, intent(in) :: colptr(*), eq(ndf, nen), offset(nen, nen)
    real(wp), intent(in) :: ke(ndf, nen, ndf, nen)
    real(wp), intent(inout) :: values(*)
    integer, intent(out) :: status
    integer :: a, b, i, k, p, row, col

    status = ok
    do b = 1, nen
      col = 0
      do k = 1, ndf
        if (eq(k, b) <= 0) cycle
        p = colptr(eq(k, b)) + 1
        row = 0
        do i = k, ndf
          if (eq(i, b) <= 0) cycle
          values(p + row) = values(p + row) + ke(i, b, k, b)
          row = row + 1
        end do
        col = col + 1
      end do
      if (col == 0) cycle
      do a = b + 1, nen
        call lower_pair(ndf, nen, a, b, colptr, eq, offset, ke, values, status)
      end do
    end do
  end subroutine lower_some

  pure subroutine lower_pair(ndf, nen, a, b, colptr, eq, offset, ke, values, status)
    !! The block (a,b) between different nodes, in place or as its transpose. Nodes that share their equations (a /= b
    !! in the element, the same block in the matrix) give their block and its transpose to the diagonal block.
    integer, intent(in) :: ndf, nen, a, b
    integer, intent(in) :: colptr(*), eq(ndf, nen), offset(nen, nen)
    real(wp), intent(in) :: ke(ndf, nen, ndf, nen)
    real(wp), intent(inout) :: values(*)
    integer, intent(inout) :: status
    integer :: i, k, p, row, col

    if (offset(a, b) > 0) then
      col = 0
      do k = 1, ndf
        if (eq(k, b) <= 0) cycle
        p = colptr(eq(k, b)) + 1 + offset(a, b) - col
        do i = 1, ndf
          if (eq(i, a) <= 0) cycle
          values(p) = values(p) + ke(i, a, k, b)
          p = p + 1
        end do
        col = col + 1
      end do
    else if (offset(b, a) > 0) then
      col = 0
      do i = 1, ndf
        if (eq(i, a) <= 0) cycle
        p = colptr(eq(i, a)) + 1 + offset(b, a) - col
        do k = 1, ndf
          if (eq(k, b) <= 0) cycle
          values(p) = values(p) + ke(i, a, k, b)
          p = p + 1
        end do
        col = col + 1
      end do
    else if (offset(a, b) == 0) then
      do k = 1, ndf
        if (eq(k, b) <= 0) cycle
        p = colptr(eq(k, b)) + 1
        row = 0
        do i = k, ndf
          if (eq(i, a) <= 0) cycle
          values(p + row) = values(p + row) + (ke(i, a, k, b) + ke(k, a, i, b))
          row = row + 1
        end do
      end do
    else if (offset(a, b) == not_in_pattern .or. offset(b, a) == not_in_pattern) then
      status = stale_pattern
    end if
  end subroutine lower_pair

  pure subroutine add_full(ndf, nen, mirrored, colptr, eq, offset, ke, values, status)
    !! Both triangles. From a symmetric element each block goes to its place and its transpose to the other one.
    integer, intent(in) :: ndf, nen
    logical, intent(in) :: mirrored                   !! only blocks a >= b are given
    integer, intent(in) :: colptr(*), eq(ndf, nen), offset(nen, nen)
    real(wp), intent(in) :: ke(ndf, nen, ndf, nen)
    real(wp), intent(inout) :: values(*)
    integer, intent(out) :: status

    if (any(eq <= 0)) then
      call full_some(ndf, nen, mirrored, colptr, eq, offset, ke, values, status)
    else
      call full_all(ndf, nen, mirrored, colptr, eq, offset, ke, values, status)
    end if
  end subroutine add_full

  pure subroutine full_all(ndf, nen, mirrored, colptr, eq, offset, ke, values, status)
    !! All components free.
    integer, intent(in) :: ndf, nen
    logical, intent(in) :: mirrored
    integer, intent(in) :: colptr(*), eq(ndf, nen), offset(nen, nen)
    real(wp), intent(in) :: ke(ndf, nen, ndf, nen)
    real(wp), intent(inout) :: values(*)
    integer, intent(out) :: status
    integer :: a, b, i, k, p

    status = ok
    do b = 1, nen
      do a = 1, nen
        if (offset(a, b) < 0) then
          if (offset(a, b) == not_in_pattern) status = stale_pattern
        else if (mirrored .and. a < b) then
          do k = 1, ndf
            p = colptr(eq(k, b)) + offset(a, b)
            do i = 1, ndf
              values(p + i) = values(p + i) + ke(k, b, i, a)
            end do
          end do
        else
          do k = 1, ndf
            p = colptr(eq(k, b)) + offset(a, b)
            do i = 1, ndf
              values(p + i) = values(p + i) + ke(i, a, k, b)
            end do
          end do
        end if
      end do
    end do
  end subroutine full_all

  pure subroutine full_some(ndf, nen, mirrored, colptr, eq, offset, ke, values, status)
    !! Some components have no equation.
    integer, intent(in) :: ndf, nen
    logical, intent(in) :: mirrored
    integer, intent(in) :: colptr(*), eq(ndf, nen), offset(nen, nen)
    real(wp), intent(in) :: ke(ndf, nen, ndf, nen)
    real(wp), intent(inout) :: values(*)
    integer, intent(out) :: status
    integer :: a, b, i, k, p

    status = ok
    do b = 1, nen
      do a = 1, nen
        if (offset(a, b) < 0) then
          if (offset(a, b) == not_in_pattern) status = stale_pattern
          cycle
        end if
        do k = 1, ndf
          if (eq(k, b) <= 0) cycle
          p = colptr(eq(k, b)) + offset(a, b)
          do i = 1, ndf
            if (eq(i, a) <= 0) cycle
            p = p + 1
            if (mirrored .and. a < b) then
              values(p) = values(p) + ke(k, b, i, a)
            else
              values(p) = values(p) + ke(i, a, k, b)
            end if
          end do
        end do
      end do
    end do
  end subroutine full_some

  pure subroutine scatter_linked_matrix(matrix, ptr, eq, coef, k, status)
    !! Add T^T K T, where local dof i is the sum of coef(j) u(eq(j)) over j = ptr(i) .. ptr(i+1)-1: elements with
    !! linked dofs, constraints, globals. Each entry is searched.
    type(sparse_matrix_type), intent(inout) :: matrix
    integer, intent(in) :: ptr(:)     !! (n+1) start of the terms of each local dof, from 1
    integer, intent(in) :: eq(:)      !! equations, <= 0: none
    real(wp), intent(in) :: coef(:)
    real(wp), intent(in) :: k(:, :)   !! (n,n) all entries, also where only one triangle is stored
    integer, intent(out) :: status    !! ok, stale_pattern (the missing entries are left out)
    integer :: i, j, r, c, p

    status = ok
    do j = 1, size(k, 2)
      do c = ptr(j), ptr(j + 1) - 1
        if (eq(c) <= 0) cycle
        do i = 1, size(k, 1)
          do r = ptr(i), ptr(i + 1) - 1
            if (eq(r) <= 0) cycle
            if (matrix%pattern%symmetric .and. eq(r) < eq(c)) cycle
            p = entry_position(matrix%pattern, eq(r), eq(c))
            if (p > 0) then
              matrix%values(p) = matrix%values(p) + coef(r)*k(i, j)*coef(c)
            else
              status = stale_pattern
            end if
          end do
        end do
      end do
    end do
  end subroutine scatter_linked_matrix

  pure function entry_position(pattern, row, col) result(p)
    !! Place of an entry in values, 0 where the pattern lacks it.
    type(sparse_pattern_type), intent(in) :: pattern
    integer, intent(in) :: row, col  !! from 1
    integer :: p
    integer :: low, high, middle

    low = pattern%colptr(col) + 1
    high = pattern%colptr(col + 1) + 1
    do while (high - low > 1)
      middle = low + (high - low)/2
      if (pattern%rowind(middle) <= row - 1) then
        low = middle
      else
        high = middle
      end if
    end do
    p = merge(low, 0, pattern%rowind(low) == row - 1)
  end function entry_position

  pure function matrix_entry(matrix, row, col) result(value)
    !! One entry, 0 where the pattern lacks it.
    type(sparse_matrix_type), intent(in) :: matrix
    integer, intent(in) :: row, col  !! from 1
    real(wp) :: value
    integer :: p

    if (matrix%pattern%symmetric) then
      p = entry_position(matrix%pattern, max(row, col), min(row, col))
    else
      p = entry_position(matrix%pattern, row, col)
    end if
    value = 0
    if (p > 0) value = matrix%values(p)
  end function matrix_entry

  pure subroutine multiply(matrix, x, y)
    !! y = A x
    type(sparse_matrix_type), intent(in) :: matrix
    real(wp), intent(in) :: x(:)   !! (n)
    real(wp), intent(out) :: y(:)  !! (n)
    real(wp) :: xj, dot
    integer :: j, p, row

    associate (colptr => matrix%pattern%colptr, rowind => matrix%pattern%rowind, values => matrix%values)
      y = 0
      if (matrix%pattern%symmetric) then
        do j = 1, matrix%pattern%n
          xj = x(j)
          p = colptr(j) + 1  ! the diagonal entry comes first
          dot = values(p)*xj
          do p = colptr(j) + 2, colptr(j + 1)
            row = rowind(p) + 1
            y(row) = y(row) + values(p)*xj
            dot = dot + values(p)*x(row)
          end do
          y(j) = y(j) + dot
        end do
      else
        do j = 1, matrix%pattern%n
          xj = x(j)
          do p = colptr(j) + 1, colptr(j + 1)
            y(rowind(p) + 1) = y(rowind(p) + 1) + values(p)*xj
          end do
        end do
      end if
    end associate
  end subroutine multiply

  pure function largest_diagonal(matrix) result(largest)
    !! max |A(i,i)|
    type(sparse_matrix_type), intent(in) :: matrix
    real(wp) :: largest
    integer :: j

    largest = 0
    do j = 1, matrix%pattern%n
      largest = max(largest, abs(matrix_entry(matrix, j, j)))
    end do
  end function largest_diagonal

  pure function largest_offdiagonal(matrix) result(largest)
    !! max |A(i,j)|, i /= j
    type(sparse_matrix_type), intent(in) :: matrix
    real(wp) :: largest
    integer :: j, p

    largest = 0
    do j = 1, matrix%pattern%n
      do p = matrix%pattern%colptr(j) + 1, matrix%pattern%colptr(j + 1)
        if (matrix%pattern%rowind(p) /= j - 1) largest = max(largest, abs(matrix%values(p)))
      end do
    end do
  end function largest_offdiagonal
end module sparse_matrix
