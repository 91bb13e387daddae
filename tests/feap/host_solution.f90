module host_solution
  !! The solution part of a deck: steps and Newton's method in FEAP's order of calls, history swapped, prescribed
  !! displacements brought in by a tangent of their own, one dense matrix whose entries must lie in the profile.
  use feap_items, only: item_list, read_items
  use host_mesh, only: material_element, material_history, call_element
  use host_memory, only: reserve_real
  implicit none
  private
  public :: solve

  type :: command_type
    character(4) :: word
    character(15) :: option
    real(8) :: number, second = 0
    integer :: partner = 0               !! NEXT of a LOOP and back
  end type command_type

  real(8), allocatable :: a(:, :)        !! tangent (neq,neq)
  real(8) :: tol = 1.0d-16, prop = 1, prldv(10) = 0, table(2, 100, 10)
  integer :: n_prop = 0, points(10) = 0
  real(8) :: largest_energy = 0

  interface
    subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
      integer, intent(in) :: n, nrhs, lda, ldb
      real(8), intent(inout) :: a(lda, *), b(ldb, *)
      integer, intent(out) :: ipiv(*), info
    end subroutine dgesv
  end interface

contains

  subroutine solve()
    !! BATCh to END, then the tables that PROP reads.
    include 'cdata.h'
    type(command_type) :: list(200)
    type(item_list) :: items
    integer :: n, i, open_loops(20), depth

    do
      call read_items(items)
      if (items%key(1) == 'batc') exit
    end do
    n = 0
    depth = 0
    do
      call read_items(items)
      if (items%key(1) == 'end') exit
      if (items%n == 0) cycle
      n = n + 1
      list(n)%word = items%key(1)
      call option_and_numbers(items%line, list(n)%option, list(n)%number, list(n)%second)
      if (list(n)%word == 'loop') then
        depth = depth + 1
        open_loops(depth) = n
      else if (list(n)%word == 'next') then
        list(n)%partner = open_loops(depth)
        list(open_loops(depth))%partner = n
        depth = depth - 1
      end if
    end do
    call number_equations()
    call place_histories()
    allocate (a(neq, neq))
    call profil_now()
    call over_elements(14, .true., .false., .false.)
    do i = 1, n
      if (list(i)%word == 'prop') call read_tables(items, nint(max(list(i)%number, list(i)%second)))
    end do
    call carry_out(list(1:n))
  end subroutine solve

  subroutine option_and_numbers(line, option, number, second)
    !! `WORD,option,number,second`: commas hold empty items.
    character(*), intent(in) :: line
    character(15), intent(out) :: option
    real(8), intent(out) :: number, second
    character(15) :: items(4)
    integer :: i, k, code

    items = ' '
    i = 1
    do k = 1, len(line)
      if (line(k:k) == ',') then
        i = i + 1
        if (i > 4) exit
      else
        items(i) = trim(items(i))//line(k:k)
      end if
    end do
    option = items(2)
    number = 0
    second = 0
    read (items(3), *, iostat=code) number
    read (items(4), *, iostat=code) second
  end subroutine option_and_numbers

  subroutine carry_out(list)
    !! One command after the other; a converged TANG leaves the loop that it stands in.
    type(command_type), intent(in) :: list(:)
    integer :: passes(size(list))            ! of each LOOP so far
    integer :: open_loops(20), depth, i
    logical :: converged

    depth = 0
    i = 1
    do while (i <= size(list))
      select case (list(i)%word)
      case ('loop')
        depth = depth + 1
        open_loops(depth) = i
        passes(i) = 1
      case ('next')
        associate (first => list(i)%partner)
          passes(first) = passes(first) + 1
          if (passes(first) <= nint(list(first)%number)) then
            i = first
          else
            depth = depth - 1
          end if
        end associate
      case default
        call single(list(i), converged)
        if (converged .and. depth > 1) then
          i = list(open_loops(depth))%partner
          depth = depth - 1
        end if
      end select
      i = i + 1
    end do
  end subroutine carry_out

  subroutine single(command, converged)
    type(command_type), intent(in) :: command
    logical, intent(out) :: converged
    include 'cdata.h'
    include 'sdata.h'
    include 'tdata.h'
    include 'umac1.h'
    external :: umacr1, umacr2

    converged = .false.
    uct = command%word
    urest = 0
    select case (command%word)
    case ('tol');  tol = command%number
    case ('dt');   dt = command%number
    case ('time'); call new_step()
    case ('tang'); call iterate(converged)
    case ('pair'); call umacr1(command%option, [0.0d0, 0.0d0, 0.0d0])
    case ('noda'); call umacr2(command%option, [0.0d0, 0.0d0, 0.0d0])
    case ('reac'); call reactions()
    case ('stre'); call over_elements(merge(8, 4, command%option == 'NODE'), .false., .false., .false.)
    case ('chec'); call over_elements(2, .false., .false., .false.)
    case ('prop', 'nopr', 'prin', 'disp')
    case default
      print '(2a)', ' host: unknown solution command ', command%word
      error stop
    end select
  end subroutine single

  subroutine read_tables(items, many)
    !! FEAP's tables of type 2: `2 1`, then pairs of time and value to a blank record.
    type(item_list), intent(inout) :: items
    integer, intent(in) :: many
    integer :: i

    n_prop = many
    do i = 1, n_prop
      call read_items(items)
      points(i) = 0
      do
        call read_items(items)
        if (items%n == 0) exit
        points(i) = points(i) + 1
        table(:, points(i), i) = [items%number(1), items%number(2)]
      end do
    end do
  end subroutine read_tables

  subroutine number_equations()
    include 'cdata.h'
    include 'sdata.h'
    include 'pointer.h'
    include 'comblk.h'
    logical :: used(numnp)
    integer :: e, i, n
    integer(8) :: at

    used = .false.
    do e = 1, numel
      do i = 1, nen
        n = mr(np(33) + nen1*(e - 1) + i - 1)
        if (n > 0) used(n) = .true.
      end do
    end do
    neq = 0
    do n = 1, numnp
      do i = 1, ndf
        at = np(31) + ndf*(n - 1) + i - 1
        if (mr(at + nneq) == 0 .and. used(n)) then
          neq = neq + 1
          mr(at) = neq
        else
          mr(at) = -1
        end if
      end do
    end do
  end subroutine number_equations

  subroutine place_histories()
    include 'cdata.h'
    include 'sdata.h'
    include 'pointer.h'
    include 'comblk.h'
    integer :: e, n
    integer(8) :: at

    n = 0
    do e = 1, numel
      at = np(33) + nen1*(e - 1) - 1
      mr(at + nen + 1) = n
      n = n + material_history(mr(at + nen1))
      mr(at + nen + 2) = n
      n = n + material_history(mr(at + nen1))
    end do
    call reserve_real(49, n)
  end subroutine place_histories

  subroutine profil_now()
    include 'pointer.h'
    include 'comblk.h'
    external :: profil

    call profil(mr(np(21)), mr(np(34)), mr(np(31)), mr(np(33)), 2, .false.)
  end subroutine profil_now

  subroutine new_step()
    include 'cdata.h'
    include 'sdata.h'
    include 'tdata.h'
    include 'pointer.h'
    include 'comblk.h'
    integer :: e, i, k
    integer(8) :: at

    ttim = ttim + dt
    call over_elements(12, .true., .false., .false.)
    prop = merge(0.0d0, 1.0d0, n_prop > 0)
    do i = 1, n_prop
      prldv(i) = table(2, points(i), i)
      do k = points(i) - 1, 1, -1
        if (ttim <= table(1, k + 1, i)) prldv(i) = table(2, k, i) + (table(2, k + 1, i) - table(2, k, i)) &
          *(ttim - table(1, k, i))/(table(1, k + 1, i) - table(1, k, i))
      end do
      prop = prop + prldv(i)
    end do
    largest_energy = 0
    hr(np(40) + nneq:np(40) + 2*nneq - 1) = 0
    do e = 1, numel                          ! what was t_n+1 is t_n
      at = np(33) + nen1*(e - 1) - 1
      do i = 0, material_history(mr(at + nen1)) - 1
        hr(np(49) + mr(at + nen + 1) + i) = hr(np(49) + mr(at + nen + 2) + i)
      end do
    end do
  end subroutine new_step

  real(8) function load(dof, fixed)
    !! Force of a free dof, displacement of a fixed one.
    integer, intent(in) :: dof
    logical, intent(in) :: fixed
    include 'cdata.h'
    include 'sdata.h'
    include 'pointer.h'
    include 'comblk.h'
    integer :: k

    load = hr(np(27) + dof - 1)
    if (fixed) load = hr(np(27) + nneq + dof - 1)
    k = mr(np(29) + dof - 1)
    if (k == 0) load = load*prop
    if (k > 0) load = load*prldv(k)
  end function load

  subroutine iterate(converged)
    !! TANG,,1
    logical, intent(out) :: converged
    include 'cdata.h'
    include 'sdata.h'
    include 'pointer.h'
    include 'comblk.h'
    real(8) :: b(neq, 1), residual(neq), energy, value
    integer :: i, j, info, pivots(neq)
    integer(8) :: at

    do i = 1, nneq
      j = mr(np(31) + i - 1)
      if (j > 0) residual(j) = load(i, .false.)
    end do
    hr(np(26):np(26) + neq - 1) = residual
    a = 0
    call over_elements(3, .true., .true., .false.)
    b(:, 1) = hr(np(26):np(26) + neq - 1)
    residual = b(:, 1)
    call dgesv(neq, 1, a, neq, pivots, b, neq, info)
    if (info /= 0) error stop 'host: the tangent is singular'
    energy = abs(dot_product(residual, b(:, 1)))
    converged = largest_energy > 0 .and. energy <= tol*largest_energy
    if (.not. largest_energy > 0) largest_energy = energy
    do i = 1, nneq
      j = mr(np(31) + i - 1)
      at = np(40) + i - 1
      if (j > 0) then
        value = b(j, 1)
      else
        value = load(i, .true.) - hr(at)
      end if
      hr(at) = hr(at) + value
      hr(at + nneq) = hr(at + nneq) + value
      hr(at + 2*nneq) = value
    end do
  end subroutine iterate

  subroutine reactions()
    include 'cdata.h'
    include 'sdata.h'
    include 'pointer.h'
    include 'comblk.h'
    integer :: i

    do i = 1, nneq
      hr(np(26) + i - 1) = 0
      if (mr(np(31) + i - 1) > 0) hr(np(26) + i - 1) = load(i, .false.)
    end do
    call over_elements(6, .false., .true., .true.)
  end subroutine reactions

  subroutine over_elements(isw, keep_history, assembles, by_dof)
    !! One task for all elements, as FEAP does it.
    integer, intent(in) :: isw
    logical, intent(in) :: keep_history, assembles
    logical, intent(in) :: by_dof            !! the residual of all dofs, for reactions
    include 'cdata.h'
    include 'sdata.h'
    include 'eldata.h'
    include 'hdata.h'
    include 'strnum.h'
    include 'pointer.h'
    include 'comblk.h'
    real(8) :: s(nst*nst), p(2*nst), xl(ndm, nen), ul(ndf, nen, 7), tl(nen), d(10), jump(nst)
    real(8) :: swap
    integer :: ld(nst), ix(nen), e, i, k, j, node, words
    integer(8) :: at
    logical :: moved

    do e = 1, numel
      n_el = e
      at = np(33) + nen1*(e - 1) - 1
      ma = mr(at + nen1)
      words = material_history(ma)
      do i = 0, words - 1
        hr(nh1 + i) = hr(np(49) + mr(at + nen + 1) + i)
        hr(nh2 + i) = hr(np(49) + mr(at + nen + 2) + i)
      end do
      ld = 0
      xl = 0
      ul = 0
      jump = 0
      tl = 0
      moved = .false.
      nel = 0
      do i = 1, nen
        node = mr(at + i)
        ix(i) = node
        if (node == 0) cycle
        nel = i
        do j = 1, ndm
          xl(j, i) = hr(np(43) + ndm*(node - 1) + j - 1)
        end do
        do j = 1, ndf
          k = ndf*(node - 1) + j
          ul(j, i, 1) = hr(np(40) + k - 1)
          ul(j, i, 2) = hr(np(40) + nneq + k - 1)
          ul(j, i, 3) = hr(np(40) + 2*nneq + k - 1)
          ld(ndf*(i - 1) + j) = mr(np(31) + k - 1)
          if (by_dof) then
            ld(ndf*(i - 1) + j) = k
          else if (mr(np(31) + k - 1) <= 0) then
            jump(ndf*(i - 1) + j) = load(k, .true.) - ul(j, i, 1)
            moved = moved .or. abs(jump(ndf*(i - 1) + j)) > 1.0d-10*abs(ul(j, i, 1))
          end if
        end do
      end do
      pstyp = ndm
      call call_element(material_element(ma), d, ul, xl, ix, tl, s, p, ndf, ndm, nst, isw)
      if (keep_history) then
        do i = 0, words - 1
          swap = hr(np(49) + mr(at + nen + 1) + i)
          hr(np(49) + mr(at + nen + 1) + i) = hr(nh1 + i)
          hr(nh1 + i) = swap
          swap = hr(np(49) + mr(at + nen + 2) + i)
          hr(np(49) + mr(at + nen + 2) + i) = hr(nh2 + i)
          hr(nh2 + i) = swap
        end do
      end if
      if (.not. assembles) cycle
      if (isw == 3 .and. moved) then         ! FEAP calls the element again: nothing may have changed by the first call
        call call_element(material_element(ma), d, ul, xl, ix, tl, s, p, ndf, ndm, nst, 3)
        call bring_in(s, p, jump)
      end if
      call add(s, p, ld, isw == 3)
    end do

  contains

    subroutine bring_in(k, r, du)
      real(8), intent(in) :: k(nst, nst), du(nst)
      real(8), intent(inout) :: r(nst)

      r = r - matmul(k, du)
    end subroutine bring_in

    subroutine add(k, r, to, with_tangent)
      real(8), intent(in) :: k(nst, nst), r(nst)
      integer, intent(in) :: to(nst)
      logical, intent(in) :: with_tangent
      integer :: row, column

      do column = 1, nst
        if (to(column) <= 0) cycle
        hr(np(26) + to(column) - 1) = hr(np(26) + to(column) - 1) + r(column)
        if (.not. with_tangent) cycle
        do row = 1, nst
          if (to(row) <= 0) cycle
          if (to(row) < to(column)) then
            if (to(column) - to(row) > height(to(column))) error stop 'host: an entry lies outside the profile'
          end if
          a(to(row), to(column)) = a(to(row), to(column)) + k(row, column)
        end do
      end do
    end subroutine add

    integer function height(column)
      integer, intent(in) :: column

      height = mr(np(21) + column - 1)
      if (column > 1) height = height - mr(np(21) + column - 2)
    end function height
  end subroutine over_elements
end module host_solution

subroutine profil(jp, idl, eq, ix, iop, prt)
  !! Heights of the columns above the diagonal, summed up.
  implicit none
  include 'cdata.h'
  include 'sdata.h'
  integer, intent(inout) :: jp(*), idl(*)
  integer, intent(in) :: eq(ndf, *), ix(nen1, *), iop
  logical, intent(in) :: prt
  integer :: e, i, j, k, least, n

  if (iop /= 2) return
  jp(1:neq) = 0
  do e = 1, numel
    n = 0
    least = neq
    do i = 1, nen
      if (ix(i, e) == 0) cycle
      do j = 1, ndf
        k = eq(j, ix(i, e))
        if (k <= 0) cycle
        n = n + 1
        idl(n) = k
        least = min(least, k)
      end do
    end do
    do i = 1, n
      jp(idl(i)) = max(jp(idl(i)), idl(i) - least)
    end do
  end do
  do i = 2, neq
    jp(i) = jp(i) + jp(i - 1)
  end do
  if (prt) print '(a,i0)', ' profile ', jp(neq)
end subroutine profil
